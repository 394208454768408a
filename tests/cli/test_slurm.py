"""A plan through a real Slurm: a private one with two virtual nodes on this machine, which uses
nothing of the system's own, and ends with the test."""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import sys
import time

import cli_case
import sweep_case

NEEDED = ("slurmctld", "slurmd", "munged", "sbatch", "squeue", "sinfo", "scontrol")
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"
CONFIGURATION = r"""ClusterName=sphbench
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={dir}/munge.sock
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={ports[0]}
StateSaveLocation={dir}/state
SlurmdSpoolDir={dir}/spool_%n
SlurmctldPidFile={dir}/slurmctld.pid
SlurmdPidFile={dir}/slurmd_%n.pid
SlurmctldLogFile={dir}/slurmctld.log
SlurmdLogFile={dir}/slurmd_%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=1,sched_interval=2
ReturnToService=2
MailProg=/bin/true
JobCompType=jobcomp/filetxt
JobCompLoc={dir}/done.txt
NodeName=n[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{ports[1]}-{ports[2]}] CPUs=1 \
  RealMemory=1000
PartitionName=local Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def lacking():
    return [name for name in NEEDED if not shutil.which(name, path=PATH)]


def free_ports():
    """One, and two that follow each other."""
    for first in range(26817, 60000, 7):
        try:
            for port in range(first, first + 3):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
        except OSError:
            continue
        return range(first, first + 3)
    raise OSError("no free ports")


class Slurm(sweep_case.Case):
    def setUp(self):
        super().setUp()
        self.slurm = self.dir / "slurm"
        for name in ("state", "spool_n1", "spool_n2"):
            (self.slurm / name).mkdir(parents=True)
        self.env = dict(os.environ, PATH=PATH, SLURM_CONF=str(self.slurm / "slurm.conf"),
                        OMP_NUM_THREADS="1")
        (self.slurm / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], dir=self.slurm, user=getpass.getuser(),
            ports=free_ports()))
        self.start_munge()
        self.daemon("slurmctld", "-D")
        for node in ("n1", "n2"):
            self.daemon("slurmd", "-D", "-N", node)
        self.wait_for(lambda: self.ask("sinfo", "-h", "-N", "-o", "%t").split() == ["idle"] * 2,
                      "both nodes")

    def daemon(self, *words):
        with open(self.slurm / f"{words[0]}.out.log", "a") as log:
            child = subprocess.Popen(words, env=self.env, stdin=subprocess.DEVNULL, stdout=log,
                                     stderr=log)

        def stop():
            child.send_signal(signal.SIGTERM)
            try:
                child.wait(20)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        self.addCleanup(stop)

    def start_munge(self):
        key = self.slurm / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.daemon("munged", "-F", "-f", f"--key-file={key}",
                    f"--socket={self.slurm}/munge.sock", f"--pid-file={self.slurm}/munged.pid",
                    f"--log-file={self.slurm}/munged.log", f"--seed-file={self.slurm}/seed")
        self.wait_for((self.slurm / "munge.sock").exists, "munge")

    def ask(self, *words):
        return subprocess.run(words, env=self.env, cwd=self.dir, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=30).stdout

    def wait_for(self, is_there, what, limit=90):
        until = time.monotonic() + limit
        while not is_there():
            if time.monotonic() > until:
                said = "".join(f"\n--- {path.name}\n{path.read_text(errors='replace')[-1500:]}"
                               for path in sorted(self.slurm.glob("*.log")))
                self.fail(f"waited in vain for {what}{said}")
            time.sleep(0.1)

    def submit(self):
        number = self.ask("sbatch", "--parsable", "job/job.sh").strip()
        self.assertTrue(number.isdigit(), number)
        return number

    def wait_for_the_end(self):
        self.wait_for(lambda: self.ask("squeue", "-h") == "", "the end of the job", 300)

    def states(self):
        """Of every task that ended, by the controller's own list: (state, node)."""
        rows = [dict(word.split("=", 1) for word in line.split() if "=" in word)
                for line in (self.slurm / "done.txt").read_text().splitlines()]
        return [(row["JobState"], row["NodeList"]) for row in rows]

    def test_a_plan(self):
        self.emit("slurm", "--batch", "2")
        self.submit()
        self.wait_for_the_end()
        states = self.states()
        self.assertEqual([state for state, _ in states], ["COMPLETED"] * 5)
        self.assertEqual({node for _, node in states}, {"n1", "n2"})
        self.assertEqual(len(self.parts()), 5)
        self.gathered()
        self.same_as_a_plain_sweep()

    def test_a_task_that_is_requeued(self):
        """It is stopped while it works and goes on where it was; the results are the same."""
        self.emit("slurm", "--batch", "20")
        number = self.submit()
        self.wait_for(lambda: (self.dir / "r").exists() and len(self.journal()) >= 2, "two runs")
        self.ask("scontrol", "requeue", f"{number}_0")
        self.assertLess(len(self.journal()), sweep_case.RUNS, "the task was too short")

        def ended():
            self.ask("scontrol", "update", f"JobId={number}", "StartTime=now")  # not in two minutes
            return self.ask("squeue", "-h") == ""
        self.wait_for(ended, "the end of the job", 300)
        lines = self.journal()
        self.assertEqual(len(lines), sweep_case.RUNS)
        self.gathered()
        self.same_as_a_plain_sweep()


def main():
    if lacking():
        subprocess.run([cli_case.ROOT / "tools/install-packages", "long"], check=False)
    if lacking():
        print("skipped: Slurm is missing and cannot be installed:", *lacking())
        sys.exit(77)
    if os.geteuid() != 0:
        print("skipped: a private Slurm needs root to start the tasks of its nodes")
        sys.exit(77)
    cli_case.main()


if __name__ == "__main__":
    main()
