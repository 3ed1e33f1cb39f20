"""What the comparisons have in common: running programs, and tables in Markdown."""
import os
import pathlib
import platform
import signal
import subprocess

SHARED = pathlib.Path(__file__).resolve().parent.parent.parent / "shared" / "meshes"


class Failure(Exception):
    """A program that came to no result; the text is the cause."""


def run(command, timeout, codes=(0,)):
    """What the program printed. It and all that it started are killed when the time is over."""
    with subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          start_new_session=True) as process:
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise Failure(f"more than {timeout:g} s") from None
    if process.returncode < 0:
        raise Failure(signal.Signals(-process.returncode).name)
    if process.returncode not in codes:
        raise Failure(err.strip().splitlines()[-1] if err.strip() else f"exit code {process.returncode}")
    return out


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" + " ---: |" * (len(heads) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def processor():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="ascii") if "model name" in line]
    return names[0] if names else platform.machine()
