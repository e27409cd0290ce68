#!/usr/bin/env python3
"""A real Slurm on this machine alone: a job whose time limit strikes comes to the same end as one that had time.

    slurm.py MPM [--seconds 110]

Needs root and Debian's slurm-wlm and munge. Starts munged, slurmctld and slurmd with a configuration of its own in a
temporary folder, submits scripts/site/slurm/cpu_node.sbatch, and stops them all again. The job's limit is Slurm's least, one
minute, and the run takes longer (--seconds): USR1 comes 20 to 50 s after the start, as Slurm looks every half minute.
"""
import argparse
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from mpm_regression.folders import ENVIRONMENT, differences, faults_of_folder, run

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parent.parent
DECK = ROOT / "inputs/footing_coarse.opts"
OPTIONS = ("-backend", "openmp", "-p2g", "gather", "-output_interval", "0.01", "-history_interval", "0.001")

CONFIGURATION = """ClusterName=alone
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={other_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={base}/munge.socket
CredType=cred/munge
StateSaveLocation={base}/state
SlurmdSpoolDir={base}/spool
SlurmctldPidFile={base}/slurmctld.pid
SlurmdPidFile={base}/slurmd.pid
SlurmctldLogFile={base}/slurmctld.log
SlurmdLogFile={base}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
MpiDefault=none
SwitchType=switch/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=1,sched_interval=2
ReturnToService=2
KillWait=10
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class Slurm:
    def __init__(self, base):
        self.base, self.processes = base, []
        for name in ("state", "spool", "munge"):
            (base / name).mkdir()
        os.chmod(base, 0o755)
        key = base / "munge" / "key"
        key.write_bytes(os.urandom(1024))
        os.chmod(key, 0o400)
        os.chmod(base / "munge", 0o700)
        host = os.uname().nodename.split(".")[0]
        port = 20000 + os.getpid() % 20000
        (base / "slurm.conf").write_text(CONFIGURATION.format(base=base, host=host, cores=os.cpu_count(), port=port,
                                                              other_port=port + 1))
        (base / "cgroup.conf").write_text("CgroupPlugin=autodetect\nIgnoreSystemd=yes\n")
        self.environment = {**ENVIRONMENT, "SLURM_CONF": str(base / "slurm.conf")}

    def __enter__(self):
        self.start("munged", "--foreground", "--force", f"--key-file={self.base}/munge/key",
                   f"--socket={self.base}/munge.socket", f"--log-file={self.base}/munge/log",
                   f"--pid-file={self.base}/munge/pid", f"--seed-file={self.base}/munge/seed")
        time.sleep(1)
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        for _ in range(60):
            state = self.call("sinfo", "-h", "-o", "%T", check=False)
            if state.startswith("idle"):
                return self
            time.sleep(1)
        raise RuntimeError(f"Slurm does not start: {state}; its logs are in {self.base}")

    def start(self, *words):
        log = open(self.base / f"{words[0]}.out", "w")
        self.processes.append(subprocess.Popen(words, env=self.environment, stdout=log, stderr=log))

    def __exit__(self, *_):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()

    def call(self, *words, check=True, environment=None):
        done = subprocess.run(words, env={**self.environment, **(environment or {})}, capture_output=True, text=True)
        if check and done.returncode != 0:
            raise RuntimeError(f"{words}: {done.stderr}")
        return done.stdout + ("" if check else done.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("binary")
    parser.add_argument("--seconds", type=float, default=110, help="about how long the whole run takes")
    parser.add_argument("--wait", type=int, default=1500)
    arguments = parser.parse_args()
    missing = [name for name in ("slurmctld", "slurmd", "munged", "sbatch") if not shutil.which(name)]
    if missing or os.geteuid() != 0:
        print("left out: " + (f"{', '.join(missing)} not installed" if missing else "only root can start Slurm here"))
        return
    base = pathlib.Path(tempfile.mkdtemp(prefix="mpm_slurm_"))
    began = time.time()
    run(arguments.binary, DECK, base / "trial", *OPTIONS, "-time_max_steps", 200)
    steps = str(max(1000, int(200 * arguments.seconds / (time.time() - began))))
    run(arguments.binary, DECK, base / "whole", *OPTIONS, "-time_max_steps", steps)
    with Slurm(base) as slurm:
        limits = f"--cpus-per-task=1 --time=1 --signal=B:USR1@10 --output={base}/job-%j.log"
        slurm.call("sbatch", *limits.split(), str(ROOT / "scripts/site/slurm/cpu_node.sbatch"), str(DECK), *OPTIONS, "-time_max_steps",
                   steps, environment={"MPM": str(pathlib.Path(arguments.binary).absolute()),
                                          "MPM_SCRIPTS": str(ROOT / "scripts"), "MPM_OUTPUT": str(base / "chain"),
                                          "MPM_SBATCH_OPTIONS": limits})
        until = time.time() + arguments.wait
        while slurm.call("squeue", "-h") and time.time() < until:
            time.sleep(1)
    printed = [line for log in sorted(base.glob("job-*.log"), key=lambda path: int(path.stem[4:])) for line in log.read_text().splitlines()
            if line.startswith("job ")]
    print("\n".join(printed))
    stopped = sum("exit status 75" in line for line in printed)
    if not printed or "exit status 0" not in printed[-1] or stopped < 2:
        sys.exit(f"the chain did not come to its end after two limits at least; logs are in {base}")
    found = differences(base / "whole", base / "chain") + faults_of_folder(base / "chain")
    if found:
        sys.exit(f"the results differ: {found}; they are in {base}")
    print(f"{len(printed)} jobs, {stopped} of them stopped before their limit: the same bits as one run that was not stopped")
    shutil.rmtree(base)


if __name__ == "__main__":
    main()
