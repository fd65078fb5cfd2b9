# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of softfall: `softfall COMMAND ...` finds the module of the command, reads its options and runs it.

A command is a module with `parser(prog)`, which returns its Parser, and `run(options)`, which returns the exit code.
"""
from __future__ import annotations

import argparse
import difflib
import importlib
import io
import os
import re
import signal
import sys
import threading
import warnings
from typing import Any, Sequence

from . import library, programs
from .errors import Error, InputError, lacking

COMMANDS = {  # module within the package, and what the command does
    "cfh": ("cfh_command", "find the critical fall height: where a_max or HIC reach their limits"),
    "fit": ("fit_command", "identify a foam from drops (or: fit compression, from compression tests)"),
    "foam": ("foam_command", "convert foam cards of other solvers and back, and show foams"),
    "open": ("open_command", "open the workbench in the browser: form, live sliders, curves, the drop in 3-D"),
    "protocol": ("protocol_program", "run a whole test, simulated or measured, and judge it as a laboratory does"),
    "read": ("read_program", "turn any laboratory's file into the CSV that the programs read, and say how it was read"),
    "report": ("report_command", "make the page of a drop from the files of softfall-post"),
    "rows": ("rows_command", "simulate a block of rows of a sweep, as an engine (Snakemake, Slurm) starts it"),
    "run": ("run_command", "run a drop: mesh, solution, figures and report, kept by content"),
    "sweep": ("sweep_command", "run many drops by a plan: effects, response surface, probabilities"),
    "serve": ("serve", "answer requests for drops over HTTP, by the protocol of UM-Bridge"),
}
PROGRAMS = {  # words that are handed over to the program softfall-WORD, and what it does
    "new": "make a folder with a case that runs as it stands",
    "post": "compute figures and curves from results.h5",
    "pre": "build the model of a drop from a case",
    "solve": "simulate the drop of a model",
}
RESUME = ("cfh", "fit", "protocol", "rows", "run", "sweep")  # commands that resume where they were interrupted
USAGE = 64  # exit code of a wrong command line, as of the C programs


class _Format(argparse.RawDescriptionHelpFormatter):
    """Help in the form of the C programs."""

    def add_usage(self, usage: Any, actions: Any, groups: Any, prefix: str | None = None) -> None:
        super().add_usage(usage, actions, groups, "Usage: ")

    def _format_action_invocation(self, action: argparse.Action) -> str:
        names = ", ".join(action.option_strings) or str(action.metavar or action.dest)
        return f"{names}={action.metavar}" if action.option_strings and action.metavar else names


class _Once(argparse._StoreAction):
    """An option that is given once: two values contradict each other, and an empty one names nothing."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option_string: str | None = None) -> None:
        given = vars(namespace).setdefault("_given", {}) if self.option_strings else {}
        if self.option_strings and values == "":
            parser.error(f"{option_string} is empty: give a value, or leave it out")
        if repr(given.setdefault(self.dest, values)) != repr(values):  # nan is nan
            parser.error(f"{option_string} is given twice: {given[self.dest]} and {values}")
        super().__call__(parser, namespace, values, option_string)


MOST_JOBS = 64


def add_jobs(made: "Parser") -> None:
    """Adds the options of a command that runs drops side by side in memory."""
    made.options.add_argument("-j", "--jobs", metavar="N", type=int, help=f"drops side by side, {MOST_JOBS} at most (default: as many as processors); the same results")
    made.options.add_argument("--retry", action="store_true", help="simulate drops again that failed earlier")
    made.options.add_argument("-t", "--threads", help=argparse.SUPPRESS)  # of the programs that were in C


def jobs_of(options: argparse.Namespace) -> int:
    """Returns how many drops run side by side."""
    if options.threads is not None:
        raise InputError(f"--threads={options.threads}: each drop takes one thread; give --jobs, the number of drops side by side")
    if options.jobs is not None and not 1 <= options.jobs <= MOST_JOBS:
        raise InputError(f"--jobs {options.jobs} is outside of 1 to {MOST_JOBS}")
    return options.jobs or min(MOST_JOBS, len(os.sched_getaffinity(0)))


class WrongOption(InputError):
    """The command line has an option or an argument that the command does not take, or lacks one."""


class Parser(argparse.ArgumentParser):
    """A parser with the help and the exit code of the C programs; `options` takes the options of a command."""

    def __init__(self, prog: str, usage: str, description: str, epilog: str = "") -> None:
        super().__init__(prog=prog, usage=f"{prog} {usage}", description=description, epilog=epilog, add_help=False, allow_abbrev=False,
                         formatter_class=lambda prog: _Format(prog, max_help_position=27, width=79))
        for action in (None, "store"):
            self.register("action", action, _Once)
        self.options = self.add_argument_group("options")
        self.options.add_argument("-?", "--help", action="help", help="give this help list")
        self.options.add_argument("-V", "--version", action="store_true", help="print program version")

    def parse_args(self, arguments: Any = None, namespace: Any = None) -> Any:
        """Reads the command line; --version is answered here, whatever else is missing."""
        if {"-V", "--version"} & set(arguments):
            print(f"{self.prog} {library.version()}")
            self.exit(0)
        return super().parse_args(arguments, namespace)

    def error(self, message: str) -> Any:
        """Raises the InputError of a wrong command line."""
        raise WrongOption(message, USAGE)


def _help() -> str:
    words = {name: text for name, (_, text) in COMMANDS.items()} | PROGRAMS
    lines = "\n".join(f"  {name:<10}{text}" for name, text in sorted(words.items()))
    return ("Usage: softfall WORD [OPTION...]\nPredicts what happens when a missile falls on a foam pad: one command for each task.\n\n"
            f"{lines}\n\nA first drop:\n  softfall new pad && cd pad && softfall run\n\n  -?, --help               give this help list\n  -V, --version            print program version\n\n"
            "`softfall WORD --help` lists the options of a task. Figures indicate, they do not\ncertify.\n")


def _failure(error: Exception) -> tuple[str, int]:
    """Returns the sentence and the exit code of a failure; SOFTFALL_TRACEBACK=1 shows where one came from that the user cannot mend."""
    if isinstance(error, Error):
        return str(error), error.code
    if isinstance(error, KeyError):
        return str(error.args[0]), 2
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror, 3
    if isinstance(error, ModuleNotFoundError) and not (error.name or "").startswith("softfall"):
        return lacking([str(error.name).partition(".")[0]]), 3
    if os.environ.get("SOFTFALL_TRACEBACK") == "1":
        raise error
    if isinstance(error, MemoryError):
        return f"out of memory{f': {error}' if str(error) else ''}", 6
    if isinstance(error, RecursionError):
        return "an input is nested too deep", 2
    if isinstance(error, UnicodeError):
        return f"a text cannot be read or written: {error}", 2
    return f"{type(error).__name__}: {error}; this is a mistake of softfall: report it with the input and SOFTFALL_TRACEBACK=1", 70


MOST_SENTENCE = 2000  # characters of a sentence: it may hold a value of the user


def plain(text: str) -> str:
    """Returns a text in which nothing is left that a terminal would obey.

    >>> plain("a\\x1b[31m")
    'a\\\\x1b[31m'
    """
    return re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", lambda found: ascii(found[0])[1:-1], text)


def say(text: str) -> None:
    """Prints what a command has to say."""
    print(plain(text))


def _complain(prog: str, sentence: str) -> None:
    """Prints a sentence to stderr, in one line."""
    text = plain(sentence.replace("\n", " "))
    print(f"{prog}: {text if len(text) <= MOST_SENTENCE else text[:MOST_SENTENCE] + ' ...'}", file=sys.stderr)


def values_of(texts: Sequence[str]) -> dict[str, str]:
    """Returns the values of --set KEY=VALUE, given several times; InputError if two contradict each other.

    >>> values_of(["missile.mass=4 kg", "missile.mass=4 kg"])
    {'missile.mass': '4 kg'}
    """
    values: dict[str, str] = {}
    for text in texts:
        key, equal, value = text.partition("=")
        if not equal or not key.strip():
            raise InputError(f"--set {text}: KEY=VALUE is expected, such as missile.velocity=\"5.2 m/s\"")
        if values.setdefault(key.strip(), value) != value:
            raise InputError(f"--set {text} contradicts --set {key.strip()}={values[key.strip()]}: give one of them")
    return values


def _terminate(*_: Any) -> None:
    """Ends the command as Ctrl-C does: its programs end with a checkpoint, its temporary folders go."""
    raise KeyboardInterrupt


def _hand_over(program: str, arguments: Sequence[str]) -> int:
    """Becomes a program, whose exit code is that of this process; returns only if it cannot be started."""
    try:
        path = str(programs.folder() / program)
        os.execv(path, [path, *arguments])
    except Error as error:
        print(f"softfall: {error}", file=sys.stderr)
        return error.code
    except OSError as error:
        print(f"softfall: {path} cannot be started: {error.strerror}", file=sys.stderr)
        return 3


def main(arguments: Sequence[str]) -> int:
    """Runs a command and returns the exit code. A failure is one sentence on stderr."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files may be no text
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, _terminate)
    name = arguments[0] if arguments else ""
    if name in ("-?", "--help", "help"):
        print(_help(), end="")
        return 0
    if name in ("-V", "--version"):
        print(f"softfall {library.version()}")
        return 0
    if name in PROGRAMS:
        return _hand_over(f"softfall-{name}", arguments[1:])
    if name not in COMMANDS:
        words = sorted([*COMMANDS, *PROGRAMS])
        near = difflib.get_close_matches(name.lower(), words, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(words)}"
        print(plain(f"softfall: unknown command '{name}'; {hint}") if name else _help(), file=sys.stderr)
        return USAGE
    prog, place, rest = f"softfall {name}", COMMANDS[name][0], arguments[1:]
    if name == "fit" and list(rest[:1]) == ["compression"]:
        prog, place, rest = f"{prog} compression", "fit.compression_command", rest[1:]
    warnings.showwarning = lambda message, *_, **__: _complain(prog, f"warning: {message}")
    try:
        module = importlib.import_module(f".{place}", __package__)
        code = int(module.run(module.parser(prog).parse_args(rest)))
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print(f"{prog}: interrupted" + ("; the same command resumes" if name in RESUME else ""), file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has gone: nothing is written at the end
        return 0
    except Exception as error:
        sentence, code = _failure(error)
        _complain(prog, sentence)
        if isinstance(error, WrongOption):
            print(f"Try `{prog} --help' for more information.", file=sys.stderr)
        try:
            sys.stdout.flush()
        except OSError:  # a full disk: nothing more is written at the end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return code
