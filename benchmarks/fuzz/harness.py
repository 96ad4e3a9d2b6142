"""What the fuzzers share: workers with limits of time and memory, what counts as a fault, counts a kind, planted faults.

A fuzzer is a script that ends in ``sys.exit(main(make, planted))``. ``make(seed)`` returns what kind of case the seed stands
for and a function without arguments that runs it; the same seed always gives the same case. A case is good if the function
returns, or raises one of the ``sentences`` with one sentence as its text. Anything else is a fault: another error (an oracle
raises `AssertionError`), a text that is no sentence, over `SECONDS` of processor time, over `MEMORY` bytes above the start, a
worker that died or does not end.

``planted`` names faults as context managers that break the product on purpose while they are open; ``--planted`` runs the
fuzzer once for each and demands that it catches them all. Workers are forked, so this runs where `os.fork` does, and memory
is read as Linux has it.

    python benchmarks/fuzz/NAME.py --count 50000 --jobs 2
    python benchmarks/fuzz/NAME.py --seed 1234          # one case again, with its traceback
    python benchmarks/fuzz/NAME.py --planted
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
import traceback
import unicodedata
import warnings
from collections import Counter
from collections.abc import Callable, Generator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

import psutil

from pymoo_gridpath.errors import GridPathError

SECONDS, MEMORY = 5.0, 1e9

# A text longer than this has let the input in whole.
LONGEST_SENTENCE = 600

Make = Callable[[int], tuple[str, Callable[[], object]]]


@dataclass(frozen=True)
class Outcome:
    """What became of one case: ``fault`` is "" where nothing is wrong; ``how`` is "result" or the class of the error."""

    seed: int
    kind: str
    how: str
    fault: str = ""


def is_sentence(text: str) -> bool:
    """Return whether a text is one printable line that says something, and not an object's address or a whole input."""
    printable = all(unicodedata.category(letter)[0] != "C" for letter in text)
    return bool(text.strip()) and printable and len(text) <= LONGEST_SENTENCE and " object at 0x" not in text


def run_case(make: Make, seed: int, sentences: tuple[type[BaseException], ...]) -> Outcome:
    """Run one case in this process and judge it, its processor time and its memory included."""
    kind, case = make(seed)
    before, began = _reset_peak(), time.process_time()
    how, fault = "result", ""
    try:
        case()
    except sentences as error:
        how = type(error).__name__
        if not is_sentence(str(error)):
            fault = f"{how} without a sentence: {str(error)[:300]!r}"
    except BaseException as error:
        how = type(error).__name__
        where = traceback.extract_tb(error.__traceback__)[-1]
        fault = f"{how} in {where.filename.rsplit('/', 1)[-1]}:{where.lineno}: {str(error)[:300]!r}"
    seconds, memory = time.process_time() - began, _peak() - before
    if not fault and seconds > SECONDS:
        fault = f"{seconds:.1f} s of processor time"
    if not fault and memory > MEMORY:
        fault = f"{memory / 1e9:.2f} GB above the start"
    return Outcome(seed, kind, how, fault)


def fuzz(
    make: Make, seeds: range, jobs: int, sentences: tuple[type[BaseException], ...] = (GridPathError,)
) -> Generator[Outcome]:
    """Yield the outcome of each seed as the workers get to it; a worker that dies or does not end is replaced."""
    context = multiprocessing.get_context("fork")
    shares = [list(seeds[k::jobs]) for k in range(jobs)]
    workers: dict[Connection, _Worker] = {}

    def start(share: list[int]) -> None:
        ours, theirs = context.Pipe(duplex=False)
        process = context.Process(target=_work, args=(make, share, sentences, theirs), daemon=True)
        process.start()
        theirs.close()
        workers[ours] = _Worker(process, share)

    for share in filter(None, shares):
        start(share)
    try:
        while workers:
            ready = wait(list(workers), timeout=0.5)
            for connection in [connection for connection in workers if connection in ready]:
                worker = workers[connection]
                try:
                    outcome = connection.recv()
                except EOFError:
                    outcome = None
                if outcome is None:
                    worker.process.join()
                    del workers[connection]
                    if worker.rest:
                        lost, *rest = worker.rest
                        yield Outcome(lost, make(lost)[0], "died", worker.why or f"worker ended with {worker.process.exitcode}")
                        if rest:
                            start(rest)
                    continue
                worker.done()
                yield outcome
            for worker in workers.values():
                worker.stop_if_lost()
    finally:
        for worker in workers.values():
            worker.process.kill()


class _Worker:
    """A process, the seeds that it has not reported yet, and why it was killed."""

    def __init__(self, process, rest: list[int]):
        self.process, self.rest, self.why = process, list(rest), ""
        self._watched = psutil.Process(process.pid)
        self._start()

    def _start(self) -> None:
        self._since, self._processor = time.monotonic(), self._used()

    def _used(self) -> float:
        try:
            times = self._watched.cpu_times()
        except psutil.Error:
            return 0.0
        return times.user + times.system

    def done(self) -> None:
        self.rest.pop(0)
        self._start()

    def stop_if_lost(self) -> None:
        """Kill the process where its case has used far more than it may, or waits for something."""
        try:
            memory = self._watched.memory_info().rss
        except psutil.Error:
            return
        if self._used() - self._processor > 3 * SECONDS or time.monotonic() - self._since > 60 * SECONDS:
            self.why = f"did not end within {3 * SECONDS:g} s of processor time or {60 * SECONDS:g} s"
        elif memory > 6 * MEMORY:
            self.why = f"over {6 * MEMORY / 1e9:g} GB"
        if self.why:
            self.process.kill()


def _work(make: Make, share: list[int], sentences, connection: Connection) -> None:
    warnings.simplefilter("ignore")
    for seed in share:
        connection.send(run_case(make, seed, sentences))
    connection.close()


def _status(key: str) -> float:
    with open("/proc/self/status") as stream:
        return next(float(line.split()[1]) * 1024 for line in stream if line.startswith(key))


def _reset_peak() -> float:
    """Begin to watch the peak of resident memory anew; return what is in use."""
    with open("/proc/self/clear_refs", "w") as stream:
        stream.write("5")
    return _status("VmRSS")


def _peak() -> float:
    return _status("VmHWM")


def main(
    make: Make,
    planted: Mapping[str, Callable[[], AbstractContextManager]],
    count: int,
    sentences: tuple[type[BaseException], ...] = (GridPathError,),
    planted_count: int = 10_000,
) -> int:
    """Run a fuzzer's command line; return 0 if there was no fault, or every planted one was caught.

    Parameters
    ----------
    make : callable
        From a seed to a kind and a case, see the module.
    planted : mapping of str to callable
        Each returns a context manager that holds one fault of the product while it is open.
    count : int
        Cases by default.
    sentences : tuple of exception classes
        What a bad input may raise.
    planted_count : int
        How many cases a planted fault may stay hidden for.
    """
    parser = argparse.ArgumentParser(description=(make.__doc__ or "").strip() or None)
    parser.add_argument("--count", type=int, default=count, metavar="N", help=f"cases (default: {count})")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="seed of the first case (default: 0)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (default: 2)")
    parser.add_argument("--seed", type=int, metavar="SEED", help="run this case alone, in this process")
    parser.add_argument("--planted", action="store_true", help="break the product in each way on purpose; all must be caught")
    arguments = parser.parse_args()
    if arguments.seed is not None:
        kind, case = make(arguments.seed)
        print(f"{kind}: {case()!r}")
        return 0
    if arguments.planted:
        return _catch(make, planted, range(arguments.first, arguments.first + planted_count), arguments.jobs, sentences)
    kinds: Counter[str] = Counter()
    results: Counter[str] = Counter()
    faults: list[Outcome] = []
    began = time.monotonic()
    for outcome in fuzz(make, range(arguments.first, arguments.first + arguments.count), arguments.jobs, sentences):
        kinds[outcome.kind] += 1
        results[outcome.kind] += outcome.how == "result"
        if outcome.fault:
            faults.append(outcome)
            print(f"FAULT seed {outcome.seed}, {outcome.kind}: {outcome.fault}", flush=True)
    for kind, number in sorted(kinds.items()):
        print(f"{number:>7} {kind} ({results[kind]} with a result, the others with a sentence)")
    print(f"{kinds.total()} cases of {len(kinds)} kinds in {time.monotonic() - began:.0f} s: {len(faults)} faults")
    return bool(faults)


def _catch(make: Make, planted, seeds: range, jobs: int, sentences) -> int:
    missed = 0
    for name, breaks in planted.items():
        with breaks():
            outcomes = fuzz(make, seeds, jobs, sentences)
            cases, caught = 0, None
            for outcome in outcomes:
                cases += 1
                if outcome.fault:
                    caught = outcome
                    break
            outcomes.close()
        missed += caught is None
        found = f"caught after {cases} cases: {caught.kind}: {caught.fault[:120]}" if caught else f"NOT caught in {cases} cases"
        print(f"{name}: {found}", flush=True)
    print(f"{len(planted) - missed} of {len(planted)} planted faults caught")
    return bool(missed)
