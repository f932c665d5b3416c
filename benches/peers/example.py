"""What comparisons with peers have alike: asami's programs, built, started and asked line by line; and tables."""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def built(name, release, package="asami"):
    """The path of the package's example, built."""
    command = ["cargo", "build", "-p", package, "--example", name, "--message-format=json-render-diagnostics"]
    done = subprocess.run(command + (["--release"] if release else []), cwd=ROOT, stdout=subprocess.PIPE, text=True)
    found = [json.loads(line).get("executable") for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not any(found):
        sys.exit(f"{' '.join(command)} failed with status {done.returncode}")
    return [path for path in found if path][-1]


class Example:
    """A program that says what it has, then answers each line with one."""

    def __init__(self, program, arguments):
        command = [program, *map(str, arguments)]
        self.process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.about = self._line()

    def _line(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit(f"{' '.join(self.process.args)} failed with status {self.process.wait()}")
        return json.loads(line)

    def ask(self, line):
        print(line, file=self.process.stdin, flush=True)
        return self._line()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def table(head, rows, below, file):
    """Prints a table in Markdown and what is said below it, and writes both into the file, if there is one."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows), "", below]
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
