# GPL-2.0-or-later. Servers of a test's own for cluster_test.py: sshd on the loopback, and Slurm with a single node.
"""Each engine is a context in a temporary folder. `environment` has what the scripts of tools/cluster need, and `run`
starts a script. All daemons end with the context."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

SKIPPED = 77
PATIENCE = 300  # seconds until a daemon answers or a job ends


def need(*programs):
    """Their paths. The test counts as skipped without one of them."""
    folders = os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin"
    paths = [shutil.which(program, path=folders) for program in programs]
    for program, path in zip(programs, paths):
        if not path:
            print(f"skipped: {program} is not installed")
            sys.exit(SKIPPED)
    return paths


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_for(what, condition, pause=0.05):
    """Returns when the condition is true, asked every `pause` seconds. RuntimeError after PATIENCE."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise RuntimeError(f"{what}: not within {PATIENCE} s")
        time.sleep(pause)


def listens(port):
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def end_tree(pid):
    """Kills a process and all that it started, as when a computer is switched off."""
    children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], stdout=subprocess.PIPE, text=True,
                              check=False).stdout.split()
    try:
        os.kill(pid, signal.SIGSTOP)
    except ProcessLookupError:
        return
    for child in children:
        end_tree(int(child))
    os.kill(pid, signal.SIGKILL)


class Engine:
    """A folder, an environment, and daemons that end with it."""

    def __init__(self, folder, scripts):
        self.folder, self.scripts, self.daemons = Path(folder), scripts, {}
        self.environment = {**os.environ, "HOME": str(self.folder)}
        self.computers = {}  # port to name, of ssh

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for daemon in self.daemons.values():
            end_tree(daemon.pid)
            daemon.wait()

    def daemon(self, name, *words, **more):
        with open(self.folder / f"{name}.log", "ab") as log:
            self.daemons[name] = subprocess.Popen([str(word) for word in words], stdout=log, stderr=log, **more)

    def stage(self, program, count, words, cwd):
        """Runs a stage in parts. RuntimeError with what was printed if that fails."""
        line = [self.scripts / self.name, *self.before, str(count), "--", *words]
        run = subprocess.run(line, cwd=cwd, env={**self.environment, "Q3MAP2": str(program)}, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True, check=False, timeout=PATIENCE)
        if run.returncode:
            raise RuntimeError(f"{' '.join(map(str, line))}: status {run.returncode}\n{run.stdout}")
        return run.stdout


class Ssh(Engine):
    """Three computers, two of which are on."""
    name, before = "ssh", ["pc1,pc2,pc3"]

    def start(self):
        sshd, keygen, *_ = need("sshd", "ssh-keygen", "ssh", "parallel", "rsync", "ps")
        for name in ("host", "key"):
            subprocess.run([keygen, "-q", "-t", "ed25519", "-N", "", "-f", self.folder / name], check=True)
        if os.geteuid() == 0:
            Path("/run/sshd").mkdir(exist_ok=True)
        hosts = "".join(f"Host {host}\n HostName 127.0.0.1\n Port {self._computer(sshd, host)}\n"
                        for host in ("pc1", "pc2"))
        settings = self.folder / "config"
        settings.write_text(f"{hosts}Host pc3\n HostName 127.0.0.1\n Port {free_port()}\n"
                            f"Host *\n IdentityFile {self.folder}/key\n IdentitiesOnly yes\n StrictHostKeyChecking no\n"
                            " UserKnownHostsFile /dev/null\n LogLevel ERROR\n BatchMode yes\n ConnectTimeout 5\n")
        self.environment["Q3MAP2_SSH"] = f"ssh -F {settings}"

    def _computer(self, sshd, host):
        """Starts it. Returns its port."""
        port, settings, home = free_port(), self.folder / f"sshd_{host}", self.folder / host
        home.mkdir()
        settings.write_text(f"Port {port}\nListenAddress 127.0.0.1\nHostKey {self.folder}/host\nStrictModes no\n"
                            f"AuthorizedKeysFile {self.folder}/key.pub\nPidFile none\nUsePAM no\n"
                            f"PasswordAuthentication no\nSetEnv HOME={home} PATH={os.environ['PATH']}\n")
        self.daemon(host, sshd, "-D", "-e", "-f", settings)
        wait_for(host, lambda: listens(port))
        self.computers[str(port)] = host
        return port

    def switch_off_computer(self, file):
        """Waits until the file has a port, and switches off the computer that listens there."""
        wait_for("a part", lambda: file.exists() and file.read_text().endswith("\n"))
        end_tree(self.daemons[self.computers[file.read_text().strip()]].pid)


class Mpi(Engine):
    name, before = "mpi", []

    def start(self):
        need("mpirun")
        more = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        self.environment["MPIRUN"] = " ".join(["mpirun", *more, "--oversubscribe", "--bind-to", "none", "-n", "2"])


class Slurm(Engine):
    """munged, slurmctld and slurmd with a node of 16 processors that the computer does not have."""
    name, before = "slurm", []

    def start(self):
        munged, controller, node, *_ = need("munged", "slurmctld", "slurmd", "sbatch", "squeue", "ps")
        user = subprocess.run(["id", "-un"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
        host = socket.gethostname().split(".")[0]
        key, munge = self.folder / "munge.key", self.folder / "munge.socket"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.folder.chmod(0o755)
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        ports = [free_port(), free_port()]
        settings = self.folder / "slurm.conf"
        settings.write_text(f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={munge}
CryptoType=crypto/munge
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/controller.pid
SlurmdPidFile={self.folder}/node.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0,bf_interval=1
SlurmdParameters=config_overrides
JobAcctGatherType=jobacct_gather/none
NodeName={host} NodeAddr=127.0.0.1 CPUs=16 RealMemory=1000 State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        self.environment["SLURM_CONF"] = str(settings)
        self.daemon("munged", munged, "-F", "-f", f"--key-file={key}", f"--socket={munge}",
                    f"--log-file={self.folder}/munge.log", f"--pid-file={self.folder}/munge.pid",
                    f"--seed-file={self.folder}/munge.seed")
        wait_for("munged", munge.exists)
        self.daemon("slurmctld", controller, "-D", "-f", settings, env=self.environment)
        self.daemon("slurmd", node, "-D", "-f", settings, env=self.environment)
        wait_for("slurmd", lambda: "idle" in self._ask("sinfo", "-h", "-o", "%T"))

    def _ask(self, *words):
        return subprocess.run(words, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False).stdout

    def stage(self, program, count, words, cwd):
        printed = super().stage(program, count, words, cwd)
        parts = Path(cwd) / Path(words[-1]).with_suffix(".parts")
        wait_for("slurm", lambda: not parts.exists() or not self._ask("squeue", "-h").strip(), 0.5)
        log = parts.with_name(parts.name + ".log")
        printed += log.read_text() if log.exists() else ""
        if parts.exists():
            raise RuntimeError(f"the jobs ended without a map\n{printed}")
        return printed


ENGINES = {engine.name: engine for engine in (Ssh, Mpi, Slurm)}
