"""A simulated robot on a pseudo-terminal: the program `deltarobot`, in the PATH."""

import itertools
import subprocess
import time
from pathlib import Path
from typing import Callable, Iterator

import pytest

Sim = Callable[..., "Simulator"]


class Simulator:
    """A running simulator: the path of its port, and a way to end it."""

    def __init__(self, port: Path, arguments: tuple[str, ...]) -> None:
        self.port = str(port)
        command = ["deltarobot", "sim", "--link", self.port, *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        while not port.exists():
            assert self.process.poll() is None, "the simulator has ended"
            time.sleep(0.01)

    def end(self) -> None:
        self.process.terminate()
        self.process.wait()


@pytest.fixture
def sim(tmp_path: Path) -> Iterator[Sim]:
    """Starts simulators with the options that it is given."""
    running: list[Simulator] = []
    names = (tmp_path / f"robot{number}" for number in itertools.count())

    def start(*arguments: str) -> Simulator:
        running.append(Simulator(next(names), arguments))
        return running[-1]

    yield start
    for simulator in running:
        simulator.end()
