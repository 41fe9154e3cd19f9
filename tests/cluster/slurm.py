# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""A cluster of Slurm on this machine: one controller and two nodes of one processor, all in one folder.

It needs root, but no systemd: it has a key and a socket of munge of its own. Its daemons end with it.
"""
import os
import shutil
import signal
import socket
import subprocess
import time

NODES = ("first", "second")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "sacct")


def missing():
    """Why there can be no cluster; empty if there can."""
    programs = [name for name in PROGRAMS if shutil.which(name, path=os.defpath + ":/usr/sbin:/sbin") is None]
    if programs:
        return f"{', '.join(programs)} missing (deps.txt, group cluster)"
    return "" if os.geteuid() == 0 else "the daemons of Slurm must be started by root"


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def wait_for(condition, what, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {seconds} s")
        time.sleep(0.1)


class Cluster:
    """Started by `with`; its calls see it by `environment`."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"),
                                PATH=os.environ["PATH"] + ":/usr/sbin:/sbin")
        self.daemons = {}

    def __enter__(self):
        try:
            self.configure()
            self.start("munged", ["munged", "--foreground", "--force", f"--key-file={self.folder}/munge.key",
                                  f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munge.pid",
                                  f"--seed-file={self.folder}/munge.seed", f"--log-file={self.folder}/munge.log"])
            wait_for((self.folder / "munge.socket").exists, "munge")
            self.start("slurmctld", ["slurmctld", "-D", "-i"])
            for node in NODES:
                self.start_node(node)
            wait_for(lambda: self.call("sinfo", "-h", "-o", "%T %D").strip() == f"idle {len(NODES)}", "nodes of Slurm")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process, _variables in list(self.processes()):
            kill(process)
        for daemon in self.daemons.values():
            daemon.wait()

    def configure(self):
        host = socket.gethostname()
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        nodes = "".join(f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={free_port()} CPUs=1 RealMemory=1000\n"
                        for node in NODES)
        (self.folder / "slurm.conf").write_text(f"""ClusterName=palpate
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={self.folder}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool.%n
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
JobRequeue=1
{nodes}PartitionName=all Nodes={','.join(NODES)} Default=YES MaxTime=10
""")

    def start(self, name, words):
        with open(self.folder / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen(words, env=self.environment, stdout=out, stderr=out,
                                                  start_new_session=True)

    def start_node(self, node):
        self.start(node, ["slurmd", "-D", "-N", node])

    def kill_node(self, node):
        """The node is gone at once with the steps and jobs on it, and the controller is told."""
        jobs = [process for process, variables in self.processes() if f"SLURMD_NODENAME={node}" in variables]
        steps = [parent for parent in map(parent_of, jobs) if parent not in (None, 1)]
        daemon = self.daemons.pop(node)
        for process in [daemon.pid, *steps, *jobs]:
            kill(process)
        daemon.wait()
        self.call("scontrol", "update", f"nodename={node}", "state=down", "reason=killed")

    def processes(self):
        """The daemons, and what they have started, with their environments."""
        for process in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{process}/environ", encoding="utf-8", errors="replace") as environment:
                    variables = environment.read().split("\0")
            except OSError:
                continue
            if int(process) != os.getpid() and f"SLURM_CONF={self.folder}/slurm.conf" in variables:
                yield int(process), variables

    def call(self, *words):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
        return done.stdout


def parent_of(process):
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8", errors="replace") as stat:
            return int(stat.read().rpartition(")")[2].split()[1])
    except OSError:
        return None


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass
