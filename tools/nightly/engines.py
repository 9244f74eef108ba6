# GPL-2.0-or-later. Where jobs run: in processes here, on a cluster with Slurm, on hosts by GNU parallel over ssh.
"""An engine is run(store, work, done), which returns when all jobs have ended. work: map to names of its stages, longest
first; done(map) is called when its last job has ended. ENGINES has them by name."""

import heapq
import os
import shlex
import shutil
import subprocess
import threading
import time
from pathlib import Path

import job

JOB = Path(__file__).resolve().parent / "job.py"
POLL = 1.0        # seconds between questions to Slurm
SPARE_MINUTES = 2  # that Slurm gives beyond the limit of the job, which ends the stage itself


class EngineError(Exception):
    """The text is for the user."""


class Local:
    """A pool of threads, each with a process at a time. A stage is ready when the stage before is done."""

    def __init__(self, words):
        self.jobs = words.jobs or max(1, (os.cpu_count() or 1) // 2)
        self.threads = max(1, (os.cpu_count() or 1) // self.jobs)

    def run(self, store, work, done):
        changed, ready, open_jobs, faults = threading.Condition(), [], len(work), []
        for order, (one, stages) in enumerate(work.items()):
            ready.append((order, 0, one, stages))

        def worker():
            nonlocal open_jobs
            while True:
                with changed:
                    changed.wait_for(lambda: ready or not open_jobs or job.stopping.is_set())
                    if not ready or job.stopping.is_set():
                        return
                    order, index, one, stages = heapq.heappop(ready)
                try:
                    good = job.run_stage(store.tasks / one.name, stages[index])
                except Exception as error:  # pylint: disable=broad-except # reported by the night
                    faults.append(error)
                    job.stop_all()
                    good = False
                with changed:
                    if job.stopping.is_set():
                        changed.notify_all()
                        return
                    if good and index + 1 < len(stages):
                        heapq.heappush(ready, (order, index + 1, one, stages))
                    else:
                        open_jobs -= 1
                        done(one)
                    changed.notify_all()

        workers = [threading.Thread(target=worker) for _ in range(self.jobs)]
        for thread in workers:
            thread.start()
        for thread in workers:
            while thread.is_alive():  # with a timeout, so that signals arrive
                thread.join(0.2)
        if faults:
            raise faults[0]


class Slurm:
    """An array of jobs for each stage, in which each job waits for that of the same map in the array before. Maps with the
    same stages are in the same arrays. The nodes share the work folder."""
    threads = 0

    def __init__(self, words):
        self.jobs = words.jobs
        if not shutil.which("sbatch"):
            raise EngineError("sbatch is not installed")

    @staticmethod
    def _ask(*line):
        run = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if run.returncode:
            raise EngineError(f"{line[0]}: {run.stdout.strip()}")
        return run.stdout.strip()

    def _submit(self, store, group, maps, stages):
        """Jobs of maps that have the same stages. Their numbers."""
        tasks, numbers = store.tasks / f"group{group}", []
        tasks.write_text("".join(f"{store.tasks / one.name}\n" for one in maps))
        minutes = int(max(one.seconds for one in maps) / 60) + SPARE_MINUTES
        for stage in stages:
            limit = f"%{self.jobs}" if self.jobs else ""
            after = [f"--dependency=aftercorr:{numbers[-1]}"] if numbers else []
            command = shlex.join(["exec", "python3", str(JOB), str(tasks), stage])
            number = self._ask("sbatch", "--parsable", f"--array=0-{len(maps) - 1}{limit}", f"--time={minutes}", *after,
                               f"--job-name=night-{stage}", f"--output={store.tasks}/slurm.log", "--open-mode=append",
                               f"--wrap={command}")
            numbers.append(number.split(";")[0])
            with open(store.tasks / "slurm_jobs", "a") as file:
                file.write(numbers[-1] + "\n")
        return numbers

    def _alive(self, numbers):
        """Whether a job runs or can still run, or Slurm does not answer."""
        try:
            listed = [line.split(maxsplit=1) for line in self._ask("squeue", "-h", "--me", "-o", "%F %r").splitlines()]
        except EngineError:
            return True
        return any(number in numbers and reason != "DependencyNeverSatisfied" for number, reason in listed)

    @staticmethod
    def cancel(store):
        """Ends the jobs of a night that are left."""
        numbers = store.tasks / "slurm_jobs"
        if numbers.exists():
            subprocess.run(["scancel", *numbers.read_text().split()], stderr=subprocess.DEVNULL, check=False)
            numbers.unlink()

    def run(self, store, work, done):
        self.cancel(store)
        groups = {}
        for one, stages in work.items():
            groups.setdefault(tuple(stages), []).append(one)
        numbers = [number for group, (stages, maps) in enumerate(groups.items())
                   for number in self._submit(store, group, maps, stages)]
        quiet = 0  # between a job and the one that waits for it, Slurm may list neither
        while quiet < 2 and not job.stopping.is_set():
            time.sleep(POLL)
            quiet = 0 if self._alive(numbers) else quiet + 1
        self.cancel(store)  # and jobs that wait for one that was killed
        if not job.stopping.is_set():
            for one in work:
                done(one)


class Parallel:
    """One job of GNU parallel for all stages of a map, since hosts share no folder: what the stages leave to each other
    stays on the host. If a host dies, parallel starts the job on another."""
    threads = 0

    def __init__(self, words):
        if not shutil.which("parallel"):
            raise EngineError("GNU parallel is not installed")
        if not words.hosts:
            raise EngineError("the engine parallel needs --hosts")
        self.jobs, self.ssh = words.jobs or 1, os.environ.get(
            "Q3MAP2_SSH", "ssh -o BatchMode=yes -o ConnectTimeout=5 -o ServerAliveInterval=5")
        self.hosts = [host for host in words.hosts.split(",") if host == ":" or self._answers(host)]
        if not self.hosts:
            raise EngineError("no host answers")

    def _answers(self, host):
        run = subprocess.run([*shlex.split(self.ssh), host, "true"], stdin=subprocess.DEVNULL, check=False)
        if run.returncode:
            print(f"{host} does not answer, and gets no job", flush=True)
        return run.returncode == 0

    def run(self, store, work, done):
        for one in work:
            shutil.copyfile(JOB, store.tasks / one.name / "job.py")
        folder, log = shlex.quote(str(store.folder)), store.tasks / "jobs.tsv"
        command = f"[ -e tasks/{{}} ] || cd {folder}; python3 tasks/{{}}/job.py tasks/{{}}; [ -e tasks/{{}}/out ]"
        words = ["parallel", "--ssh", self.ssh, "--jobs", str(self.jobs), "--retries", "4", "--workdir", "...", "--cleanup",
                 "--transferfile", "tasks/{}", "--return", "tasks/{}/out", "--joblog", str(log)]
        for host in self.hosts:
            words += ["--sshlogin", f"1/{host}"]
        with subprocess.Popen([*words, command], cwd=store.folder, stdin=subprocess.PIPE, text=True,
                              start_new_session=True) as run:
            run.stdin.write("".join(f"{one.name}\n" for one in work))
            run.stdin.close()
            while run.poll() is None:
                if job.stopping.is_set():
                    run.terminate()
                time.sleep(0.2)
        if not job.stopping.is_set():
            for one in work:
                done(one)


ENGINES = {"local": Local, "slurm": Slurm, "parallel": Parallel}
