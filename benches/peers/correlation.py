#!/usr/bin/env python3
"""Seconds to correlate what 63 pairs of adjacent lasers saw during 200 s, over all lags: asami beside SciPy, and beside the definition.

    pip install numpy scipy
    python3 benches/peers/correlation.py [--seconds S] [--seed S] [--rounds N] [--slow N] [--direct N] [--release] [--table FILE]

The task of section 5.1 of Stronger (2008): of each pair the normalised correlation over the places where both have a return, at every lag up to half
a turn to either side. Ranges as they are, of scenarios/car.toml.

asami (`cargo run --example laser_lags`) transforms blocks of each signal once for each part it plays, adds up the products' spectra over the
blocks, and transforms these back.
scipy.fft: as Padfield (2012) has it, a pair's signals, squares and masks transformed whole, six products transformed back, at the next fast length.
scipy.signal.correlate: the six sums by its own FFT method, of `--slow` pairs only, and as many times that as there are pairs more.
The definition: exact sums in whole numbers at every lag, of `--direct` pairs only (asami's own, compiled); coefficients are compared with it.

Each has one thread; what counts is the processor's time, by turns `--rounds` times, the median of each.
"""

import argparse
import importlib.metadata
import os
import pathlib
import statistics
import sys
import tempfile
import time

# Before anything starts threads.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

try:
    import numpy as np
    import scipy.fft
    import scipy.signal
except ImportError as missing:
    sys.exit(f"correlation.py needs the Python package {missing.name!r}: pip install numpy scipy")

from example import Example, built, table

ABSENT = -32768


def parts(signal):
    """Mask, values and squares, of values less the mean of all: that changes no coefficient, and costs no digits."""
    mask = signal != ABSENT
    values = np.where(mask, signal.astype(np.float64) - signal[mask].mean() if mask.any() else 0.0, 0.0)
    return mask.astype(np.float64), values, values * values


def coefficients(count, x, y, xx, yy, xy):
    with np.errstate(invalid="ignore", divide="ignore"):
        return (count * xy - x * y) / np.sqrt((count * xx - x * x) * (count * yy - y * y))


def by_fft(a, b, most):
    size = scipy.fft.next_fast_len(len(a) + most, real=True)
    (ma, va, sa), (mb, vb, sb) = ([scipy.fft.rfft(part, size, workers=1) for part in parts(s)] for s in (a, b))

    def sums(first, second):
        all_lags = scipy.fft.irfft(first.conj() * second, size, workers=1)
        return np.concatenate([all_lags[-most:], all_lags[:most + 1]])

    return coefficients(np.rint(sums(ma, mb)), sums(va, mb), sums(ma, vb), sums(sa, mb), sums(ma, sb), sums(va, vb))


def by_correlate(a, b, most):
    (ma, va, sa), (mb, vb, sb) = parts(a), parts(b)
    middle = len(a) - 1

    def sums(first, second):
        return scipy.signal.correlate(second, first, mode="full", method="fft")[middle - most:middle + most + 1]

    return coefficients(np.rint(sums(ma, mb)), sums(va, mb), sums(ma, vb), sums(sa, mb), sums(ma, sb), sums(va, vb))


def timed(correlate, signals, count, most):
    begun = time.process_time()
    found = [correlate(signals[k], signals[k + 1], most) for k in range(count)]
    return (time.process_time() - begun) * (len(signals) - 1) / count, np.array(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=200.0, help="of the drive (default 200)")
    parser.add_argument("--seed", type=int, default=1000, help="of the drive (default 1000)")
    parser.add_argument("--rounds", type=int, default=3, help="how often each is timed (default 3)")
    parser.add_argument("--slow", type=int, default=4, help="pairs that scipy.signal.correlate is timed on (default 4)")
    parser.add_argument("--direct", type=int, default=4, help="pairs that are summed by the definition (default 4)")
    parser.add_argument("--release", action="store_true", help="time asami built with --release, not the dev profile")
    parser.add_argument("--table", type=pathlib.Path, help="writes the table there, in Markdown")
    arguments = parser.parse_args()
    rounds, spent, off = max(arguments.rounds, 1), {}, {}
    profile, scipys = "release" if arguments.release else "dev", importlib.metadata.version("scipy")
    with tempfile.TemporaryDirectory() as folder:
        ours = Example(built("laser_lags", arguments.release), [folder, "scenarios/car.toml", arguments.seed, arguments.seconds])
        about = ours.about
        signals = np.fromfile(pathlib.Path(folder) / "signals.i16", np.int16).reshape(about["lasers"], -1)
        pairs, most = about["lasers"] - 1, about["most_lag"]
        peers = {f"scipy.fft {scipys}": (by_fft, pairs), f"scipy.signal.correlate {scipys}": (by_correlate, max(1, min(arguments.slow, pairs)))}
        for _ in range(rounds):
            spent.setdefault(f"asami ({profile})", []).append(ours.ask("correlate")["seconds"])
            mine = np.fromfile(pathlib.Path(folder) / "coefficients.f64", np.float64).reshape(pairs, -1)
            for name, (correlate, count) in peers.items():
                seconds, found = timed(correlate, signals, count, most)
                spent.setdefault(name, []).append(seconds)
                off[name] = np.nanmax(np.abs(found - mine[:count]))
        exact = ours.ask(f"direct {max(1, arguments.direct)}")
        ours.close()
    name = f"the definition ({profile}; {len(exact['pairs'])} pairs)"
    spent[name], off[name] = [exact["seconds"] * pairs / len(exact["pairs"])], exact["off"]
    seconds = {name: statistics.median(found) for name, found in spent.items()}
    first = seconds[f"asami ({profile})"]
    head = ["method", "s for all pairs", "times asami's", "greatest difference of a coefficient to asami's"]
    rows = [[name, f"{s:.2f}", f"{s / first:.1f}", f"{off[name]:.1e}" if name in off else ""] for name, s in seconds.items()]
    below = (f"{pairs} pairs, {2 * most + 1} lags, {signals.shape[1]} firings; counts of places are off the definition's by at most {exact['miscounted']}. "
             f"Processor time, one thread each, median of {rounds} rounds; of scipy.signal.correlate and of the definition, some pairs stand for all.")
    table(head, rows, below, arguments.table)


if __name__ == "__main__":
    main()
