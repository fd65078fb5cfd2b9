#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the cells of a notebook in the present folder, and writes what they print and draw into it.

    tools/notebook.py NOTEBOOK.ipynb [--check]

--check writes nothing, and exits 1 if a text differs: a number by more than 2 %, or anything else. Needs no Jupyter: a cell is run
as Python, the value of its last expression is shown, and its figures of matplotlib are its pictures."""
import ast
import base64
import contextlib
import io
import json
import sys

import matplotlib
matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
from tutorial_page import differs  # noqa: E402


def pictures():
    """The figures that are open, as PNG, which are closed."""
    for number in plt.get_fignums():
        file = io.BytesIO()
        plt.figure(number).savefig(file, dpi=70, metadata={"Software": None})
        plt.close(number)
        yield {"output_type": "display_data", "metadata": {}, "data": {"image/png": base64.b64encode(file.getvalue()).decode()}}


def run(source, names):
    """Runs a cell and returns its outputs."""
    tree = ast.parse(source)
    last = ast.Expression(tree.body.pop().value) if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(tree, "cell", "exec"), names)
        value = eval(compile(last, "cell", "eval"), names) if last else None
    outputs = [{"output_type": "stream", "name": "stdout", "text": printed.getvalue()}] if printed.getvalue() else []
    drawn = list(pictures())
    if value is not None and not drawn:
        outputs.append({"output_type": "execute_result", "execution_count": None, "metadata": {}, "data": {"text/plain": repr(value)}})
    return outputs + drawn


def text_of(outputs):
    return "".join(part.get("text", "") + part.get("data", {}).get("text/plain", "") for part in outputs)


def main():
    path, check = sys.argv[1], sys.argv[2:] == ["--check"]
    with open(path, encoding="utf-8") as stream:
        notebook = json.load(stream)
    names, wrong = {"__name__": "__main__"}, 0
    for number, cell in enumerate(cell for cell in notebook["cells"] if cell["cell_type"] == "code"):
        outputs = run("".join(cell["source"]), names)
        if check and (differs(text_of(cell["outputs"]), text_of(outputs)) or len(cell["outputs"]) != len(outputs)):
            wrong += 1
            print(f"{path}, cell {number + 1} has\n{text_of(cell['outputs'])}and gives\n{text_of(outputs)}")
        cell["outputs"], cell["execution_count"] = outputs, number + 1
        for output in outputs:
            if output["output_type"] == "execute_result":
                output["execution_count"] = number + 1
    if not check:
        with open(path, "w", encoding="utf-8") as stream:
            json.dump(notebook, stream, indent=1, ensure_ascii=False)
            stream.write("\n")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
