#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A campaign on a real Slurm of one node: tests/slurm/slurm.py

Starts munged, slurmctld and slurmd in namespaces of their own (processes, network, mounts, host name), which end with this
program whatever happens to it. 160 coarse drops go through softfall sweep, Snakemake and sbatch. In the middle jobs are
cancelled, the node is drained, the campaign is interrupted, its program is killed, and then Snakemake, too. It must finish
with the figures of the same campaign on this machine alone, and so must a copy that is taken from Slurm unfinished and
ended here. The programs are those of SF_BIN_DIR, or of build/bin.
Exit code 77, with a line that says why, where it cannot run."""
import contextlib
import csv
import glob
import json
import os
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time

DROPS, PER_JOB = 160, 4
NODE = "softfall-test"
PROGRAMS = {"munged": "munge", "slurmctld": "slurmctld", "slurmd": "slurmd", "sbatch": "slurm-client", "snakemake": "snakemake",
            "unshare": "util-linux", "ip": "iproute2"}
NAMESPACES = ["unshare", "--pid", "--fork", "--kill-child", "--mount", "--mount-proc", "--net", "--uts"]
PLAN = """case = "%s/examples/eva50-v4.5/case.cfg";
set = ["geometry.parameters.fine_spacing=20.0", "geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=9.0"];
factors = ( { key = "geometry.parameters.thickness"; values = [40.0, 50.0]; },
            { key = "missile.velocity"; from = "3 m/s"; to = "5 m/s"; count = 20; },
            { key = "material.density"; from = "100 kg/m3"; to = "130 kg/m3"; count = 4; } );
"""
CONFIGURATION = """ClusterName=softfall
SlurmctldHost={node}(127.0.0.1)
SlurmctldPort=6817
SlurmdPort=6818
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdParameters=config_overrides
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=5
MinJobAge=60
NodeName={node} NodeAddr=127.0.0.1 CPUs=2 RealMemory=8000
PartitionName=all Nodes={node} Default=YES MaxTime=INFINITE State=UP
"""


def source():
    return os.environ.get("SF_SOURCE_DIR") or os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


# ---- outside of the namespaces ----


def skip(reason):
    print("slurm: skipped: " + reason)
    sys.exit(77)


def check_machine():
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    os.environ["PATH"] = path
    missing = sorted({package for program, package in PROGRAMS.items() if not shutil.which(program, path=path)})
    if os.getuid() != 0:
        skip("only root can start a Slurm with namespaces of its own")
    if missing:
        skip("packages are missing (packages.txt, sections cluster and slurm): " + " ".join(missing))
    if subprocess.run(NAMESPACES + ["true"], stderr=subprocess.DEVNULL).returncode != 0:
        skip("this root may not make namespaces (unshare)")


def outside():
    check_machine()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with tempfile.TemporaryDirectory(prefix="softfall-slurm-") as folder:
        inside = subprocess.Popen(NAMESPACES + [sys.executable, os.path.abspath(__file__), "--inside", folder])
        try:
            return inside.wait()
        finally:
            inside.kill()  # with it ends everything in the namespaces
            inside.wait()


# ---- inside ----


def wait_for(what, condition, limit=900):
    end = time.monotonic() + limit
    while not condition():
        if time.monotonic() > end:
            raise RuntimeError("waited %d s in vain for %s" % (limit, what))
        time.sleep(0.2)


def output(*words):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout


class Slurm:
    """The daemons, in the foreground, with their files in `folder`."""

    def __init__(self, folder):
        self.folder = folder
        os.mkdir(folder, 0o755)
        for name in ("state", "spool"):
            os.mkdir(os.path.join(folder, name))
        socket.sethostname(NODE)
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        # With 127.0.0.1 alone, getaddrinfo (AI_ADDRCONFIG) takes the machine for one without IPv4.
        subprocess.run(["ip", "address", "add", "127.0.0.2/8", "dev", "lo"], check=True)
        with open(self.file("munge.key"), "wb", opener=lambda name, flags: os.open(name, flags, 0o600)) as key:
            key.write(os.urandom(128))
        with open(self.file("slurm.conf"), "w") as text:
            text.write(CONFIGURATION.format(node=NODE, folder=folder))
        os.environ["SLURM_CONF"] = self.file("slurm.conf")

    def file(self, name):
        return os.path.join(self.folder, name)

    def start(self):
        options = ["--%s=%s" % (name, self.file("munge." + name.split("-")[0])) for name in
                   ("key-file", "socket", "pid-file", "log-file", "seed-file")]
        self.daemon("munged", "--foreground", "--force", *options)
        wait_for("munged", lambda: os.path.exists(self.file("munge.socket")))
        self.daemon("slurmctld", "-D", "-i")
        self.daemon("slurmd", "-D", "-N", NODE)
        wait_for("the node", lambda: "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], stdout=subprocess.PIPE,
                                                             stderr=subprocess.DEVNULL, universal_newlines=True).stdout)

    def daemon(self, name, *words):
        with open(self.file(name + ".txt"), "w") as log:
            subprocess.Popen((name,) + words, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def jobs(self, states="R"):
        return output("squeue", "-h", "-t", states, "-o", "%i").split()

    def node(self, state):
        subprocess.run(["scontrol", "update", "nodename=" + NODE, "state=" + state, "reason=test"], check=True)


class Campaign:
    """softfall sweep of the plan in `folder`, whose name has a space, as has that of the programs."""

    def __init__(self, folder):
        self.folder = folder
        programs = os.environ.pop("SF_BIN_DIR", None) or os.path.join(source(), "build", "bin")
        shutil.copytree(programs, os.path.join(folder, "bin"), ignore=lambda _, names: [n for n in names if not n.startswith("softfall")])
        shutil.copytree(os.path.join(programs, "..", "lib"), os.path.join(folder, "lib"), symlinks=True)
        shutil.copytree(os.path.join(programs, "..", "share", "softfall"), os.path.join(folder, "share", "softfall"))
        with open(os.path.join(folder, "plan.cfg"), "w") as plan:
            plan.write(PLAN % source())

    def file(self, *names):
        return os.path.join(self.folder, *names)

    def sweep(self, directory, *words):
        command = [self.file("bin", "softfall"), "sweep", "plan.cfg", "-o", directory] + list(words)
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                universal_newlines=True, start_new_session=True)

    def on_slurm(self):
        return self.sweep("out", "--engine", "snakemake", "--profile", "slurm", "--per-job", str(PER_JOB))

    def done(self):
        """Returns how many drops the store has, or a job has answered."""
        keys = set()
        if os.path.exists(self.file("out", "drops.sqlite")):
            with contextlib.closing(sqlite3.connect(self.file("out", "drops.sqlite"), timeout=60)) as data, contextlib.suppress(sqlite3.OperationalError):
                keys |= {key for key, in data.execute("SELECT key FROM drops WHERE state = 'done'")}
        for path in glob.glob(self.file("out", "batch", "*.rows")):
            with open(path) as file:
                keys |= {json.loads(line)[0] for line in file if line.startswith("[") and line.endswith("]\n")}
        return len(keys)

    def table(self, directory):
        with open(self.file(directory, "runs.csv")) as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            del row["wall_s"], row["threads"]
        return rows

    def log(self):
        with open(self.file("out", "batch", "log.txt")) as file:
            return file.read()


def expect(condition, sentence, detail=""):
    if not condition:
        raise RuntimeError("%s: %s" % (sentence, detail) if detail else sentence)


def finish(process, code, words):
    text = process.communicate(timeout=3600)[0]
    expect(process.returncode == code and words in text, "exit code %d and \"%s\" expected" % (code, words),
           "%d, %s" % (process.returncode, text[-3000:]))
    return text


def find_snakemake(folder):
    """The process of Snakemake with the campaign's manifest, not those of its jobs."""
    found = []
    for path in glob.glob("/proc/[0-9]*/cmdline"):
        try:
            with open(path, "rb") as file:
                words = file.read().split(b"\0")
        except OSError:
            continue
        if b"--profile" in words and folder.encode() in b" ".join(words):
            found.append(int(path.split("/")[2]))
    return found


def tell(campaign, words):
    print("%6.0f s  %2d drops done; %s" % (time.monotonic() - START, campaign.done(), words), flush=True)


def jobs_are_cancelled(slurm, campaign):
    """Snakemake starts jobs again that somebody has cancelled. It takes its time to see it: a drained node does no others
    meanwhile, so that drops are left for what comes next on a fast machine, too."""
    wait_for("the first drops", lambda: campaign.done() >= 2 and slurm.jobs())
    slurm.node("drain")
    jobs = slurm.jobs()
    subprocess.run(["scancel"] + jobs, check=True)
    tell(campaign, "jobs %s cancelled" % " ".join(jobs))
    wait_for("new jobs in place of the cancelled ones", lambda: campaign.log().count("Trying to restart job") >= len(jobs))
    slurm.node("resume")


def node_is_drained(slurm, campaign, process):
    """The campaign waits; interrupted, it takes its jobs from the queue."""
    wait_for("a job", slurm.jobs)
    slurm.node("drain")
    wait_for("an idle node", lambda: not slurm.jobs("R,CG"))
    before = campaign.done()
    tell(campaign, "node drained, %d jobs wait" % len(slurm.jobs("PD")))
    expect(slurm.jobs("PD") and before < DROPS, "drops are left to do when the node is drained")
    time.sleep(3)
    expect(process.poll() is None and campaign.done() == before, "the campaign waits for the drained node")
    process.terminate()
    finish(process, 130, "interrupted; the same command resumes")
    expect(not slurm.jobs("PD,R"), "an interrupted campaign leaves no jobs", slurm.jobs("PD,R"))
    slurm.node("resume")
    tell(campaign, "interrupted, queue empty, node resumed")


def programs_are_killed(slurm, campaign):
    """A Snakemake that outlives its campaign holds what it has begun; one that is killed leaves jobs that go on, here when the node
    is resumed."""
    process, before = campaign.on_slurm(), campaign.done()
    wait_for("further drops", lambda: campaign.done() > before and slurm.jobs())
    slurm.node("drain")
    process.kill()
    process.communicate()
    snakemake = find_snakemake(campaign.file("out"))
    expect(len(snakemake) == 1, "Snakemake outlives softfall sweep", snakemake)
    finish(campaign.on_slurm(), 3, "what another command in this folder has begun is among them")
    os.kill(snakemake[0], signal.SIGKILL)
    tell(campaign, "softfall sweep and then Snakemake killed, %d jobs left" % len(slurm.jobs("PD,R")))
    expect(slurm.jobs("PD,R") and campaign.done() < DROPS, "jobs are left that nobody waits for")


def statuses_are_told(campaign):
    """status.sh of jobs that are known to be cancelled, to wait or to run, or not known."""
    def status(job):
        return output(campaign.file("share", "softfall", "slurm", "status.sh"), job).strip()
    running = output("squeue", "-h", "-t", "R,PD", "-o", "%i").split()
    expect(status(running[0]) in ("running", "success"), "a job that runs is running", status(running[0]))
    expect(status("999999") == "failed", "a job that Slurm does not know has failed", status("999999"))


def finish_here(slurm, campaign):
    """What Slurm has begun, in a copy, as jobs of the original are still to come: the node is drained."""
    wait_for("an idle node", lambda: not slurm.jobs("R,CG"))
    shutil.copytree(campaign.file("out"), campaign.file("copy"))
    begun = campaign.done()
    expect(0 < begun < DROPS, "the copy has drops that are done and drops that are not", begun)
    text = finish(campaign.sweep("copy", "--jobs", "2"), 0, "%d runs: %d done, 0 failed, 0 open" % (DROPS, DROPS))
    expect("simulated, 0 were there" not in text, "drops that were done are not simulated again", text[-3000:])
    assert_same(campaign, "copy")
    tell(campaign, "a copy was finished on this machine alone, with the same figures")


def assert_same(campaign, directory):
    here, there = campaign.table("here"), campaign.table(directory)
    expect(len(here) == DROPS and here == there, "runs.csv is the same", "%s\n%s" % (here, there))


def inside(folder):
    slurm = Slurm(os.path.join(folder, "slurm"))
    os.environ["HOME"] = os.path.join(folder, "home")
    os.environ["OMP_NUM_THREADS"] = "1"
    os.mkdir(os.environ["HOME"])
    campaign = Campaign(os.path.join(folder, "a campaign"))
    try:
        slurm.start()
        finish(campaign.sweep("here", "--jobs", "2"), 0, "%d runs: %d done, 0 failed, 0 open" % (DROPS, DROPS))
        tell(campaign, "the campaign on this machine alone has ended")
        process = campaign.on_slurm()
        try:
            jobs_are_cancelled(slurm, campaign)
            node_is_drained(slurm, campaign, process)
        except RuntimeError:
            process.kill()
            print(process.communicate()[0][-3000:])
            raise
        programs_are_killed(slurm, campaign)
        statuses_are_told(campaign)
        finish_here(slurm, campaign)
        slurm.node("resume")
        finish(campaign.on_slurm(), 0, "%d runs: %d done, 0 failed, 0 open" % (DROPS, DROPS))
        tell(campaign, "finished after being resumed")
        assert_same(campaign, "out")
        tell(campaign, "runs.csv is that of the campaign on this machine alone")
        return 0
    except (RuntimeError, subprocess.SubprocessError) as failure:
        print("slurm: FAILED: %s" % failure)
        for name in sorted(glob.glob(os.path.join(folder, "slurm", "*.txt"))) + [campaign.file("out", "batch", "log.txt")]:
            if os.path.exists(name):
                with open(name, errors="replace") as file:
                    print("--- %s\n%s" % (name, file.read()[-4000:]))
        return 1


def first_process(folder):
    """Of the namespace: waits for whatever has lost its parent, or Slurm would see those processes for ever."""
    worker = os.fork()
    if worker == 0:
        sys.exit(inside(folder))
    while True:
        process, status = os.wait()
        if process == worker:
            return os.waitstatus_to_exitcode(status) & 255


START = time.monotonic()
if __name__ == "__main__":
    sys.exit(first_process(sys.argv[2]) if sys.argv[1:2] == ["--inside"] else outside())
