#!/usr/bin/env python3
"""Milliseconds of processor time per EM iteration and 1000 steps, pykalman and dynamax beside asami, on logs of one size.

    pip install pykalman==0.11.2 dynamax==1.0.3
    python3 benches/peers/em_linear.py [--release] [--rounds N] [--steps N] [--table FILE]

No peer learns asami's models. The nearest thing they do is EM on a linear system with Gaussian noise, so that is what
they get: as many steps (18 000), as many states (3: place and heading), as many numbers observed in each step (4: two
landmarks, each with height and bearing), all in 64-bit floating point. One iteration is, in each:

asami (`cargo run --example em_iterations`): a filter and a smoother over all steps, every step's motion and every
sighting linearised anew at the states found; then an M-step for the velocities of 40 actions, a cubic sensor function,
two standard deviations and the first state. Pairs of states enter with their joint distribution. `em_published` has two
filters, one forward and one backward, and a sample instead of moments, as printed by Stronger (2008); `em_rts` has an
RTS smoother; `em_exact` has exact moments, and its E-step is linearised on average over the states smoothed last.

pykalman: Kalman filter, RTS smoother, pair covariances, and an M-step for what asami learns, as far as there is a
counterpart: offset of the motion, observation matrix and covariance, mean and covariance of the first state.

dynamax: the same with an M-step for all of its matrices, which it learns together or not at all. All iterations are one
function compiled by XLA (`jax.jit`); compiling is not timed, and each run is waited for.

Neither peer linearises anything, has actions or gates sightings: asami does more in each iteration. Each has one thread,
and what counts is the processor's time, which other programs do not lengthen. What is done once, however many
iterations there are, falls out of the difference between a long and a short run. All are timed by turns, `--rounds`
times, and the median of each counts.
"""

import argparse
import importlib.metadata
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys

from example import built, table

STATES, OBSERVED = 3, 4
LEARNERS = ["em_published", "em_rts", "em_exact"]
# Iterations of a short and of a long run.
ASAMI, PYKALMAN, DYNAMAX = (25, 125), (1, 2), (2, 12)

# One thread, on the processor.
os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"


def absent(package, why):
    sys.exit(f"em_linear.py compares with pykalman and dynamax, and there is no Python package {package!r} ({why}): "
             "pip install pykalman==0.11.2 dynamax==1.0.3")


try:
    import numpy as np
    import pykalman
    import jax
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp
    import dynamax
    from dynamax.linear_gaussian_ssm import LinearGaussianSSM
except ImportError as missing:
    absent(missing.name, missing)


def asami_run(program, learner, iterations):
    done = subprocess.run([program, learner, str(iterations)], stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"{program} {learner} {iterations} failed with status {done.returncode}")
    return json.loads(done.stdout)


class Linear:
    """A state that turns slowly about the origin, seen through a matrix; and where EM starts, somewhat off."""

    def __init__(self, steps):
        rng = np.random.default_rng(1000)
        turn = np.array([[np.cos(0.05), -np.sin(0.05), 0.0], [np.sin(0.05), np.cos(0.05), 0.0], [0.0, 0.0, 0.98]])
        self.motion, self.motion_cov = 0.995 * turn, np.diag([0.1, 0.1, 0.4]) ** 2
        self.sensor, self.sensor_cov = rng.normal(size=(OBSERVED, STATES)), np.diag([0.4, 0.2, 0.4, 0.2]) ** 2
        state, seen = np.zeros(STATES), []
        for _ in range(steps):
            seen.append(self.sensor @ state + np.sqrt(np.diag(self.sensor_cov)) * rng.normal(size=OBSERVED))
            state = self.motion @ state + np.sqrt(np.diag(self.motion_cov)) * rng.normal(size=STATES)
        self.seen = np.array(seen)
        self.sensor_start, self.sensor_cov_start = 0.9 * self.sensor, 4.0 * self.sensor_cov


def rising(name, log_likelihoods):
    """EM never loses likelihood: a peer that does is not set up as it should be."""
    if not np.all(np.isfinite(log_likelihoods)) or log_likelihoods[-1] <= log_likelihoods[0]:
        sys.exit(f"{name} does not learn: log-likelihood from {log_likelihoods[0]} to {log_likelihoods[-1]}")


def spent_s():
    """Processor time of this process and of the programs that it ran to their end."""
    own, others = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime


def per_iteration(run, iterations, steps):
    """Milliseconds per iteration and 1000 steps."""
    seconds = []
    for n in iterations:
        begun = spent_s()
        run(n)
        seconds.append(spent_s() - begun)
    few, many = iterations
    return 1e3 * (seconds[1] - seconds[0]) / (many - few) / (steps / 1e3)


def pykalman_run(problem):
    learned = ["transition_offsets", "observation_matrices", "observation_covariance", "initial_state_mean",
               "initial_state_covariance"]

    def run(iterations):
        kalman = pykalman.KalmanFilter(
            transition_matrices=problem.motion, transition_covariance=problem.motion_cov,
            transition_offsets=np.zeros(STATES), observation_matrices=problem.sensor_start,
            observation_covariance=problem.sensor_cov_start, observation_offsets=np.zeros(OBSERVED),
            initial_state_mean=np.zeros(STATES), initial_state_covariance=0.01 * np.eye(STATES))
        return kalman.em(problem.seen, n_iter=iterations, em_vars=learned)

    few = problem.seen[:500]
    start, end = run(0), run(2)
    rising("pykalman", [start.loglikelihood(few), end.loglikelihood(few)])
    return run


def dynamax_run(problem):
    model = LinearGaussianSSM(state_dim=STATES, emission_dim=OBSERVED)
    start, properties = model.initialize(
        jax.random.PRNGKey(0), initial_mean=jnp.zeros(STATES), initial_covariance=0.01 * jnp.eye(STATES),
        dynamics_weights=jnp.array(problem.motion), dynamics_covariance=jnp.array(problem.motion_cov),
        emission_weights=jnp.array(problem.sensor_start), emission_covariance=jnp.array(problem.sensor_cov_start))
    seen = jnp.array(problem.seen)
    if seen.dtype != jnp.float64:
        sys.exit("dynamax does not compute in 64 bits")

    def fit(iterations):
        return jax.jit(lambda start, seen: model.fit_em(start, properties, seen, num_iters=iterations, verbose=False))

    compiled = {iterations: fit(iterations) for iterations in DYNAMAX}

    def run(iterations):
        return jax.block_until_ready(compiled[iterations](start, seen))

    for iterations in DYNAMAX:  # Compiles.
        rising("dynamax", run(iterations)[1])
    return run


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--release", action="store_true", help="time asami built with --release, not the dev profile")
    parser.add_argument("--rounds", type=int, default=5, help="how often each is timed (default 5)")
    parser.add_argument("--table", type=pathlib.Path, help="writes the table there, in Markdown")
    parser.add_argument("--steps", type=int, default=18_000, help="steps of the peers' log (default 18000, asami's)")
    arguments = parser.parse_args()
    rounds = max(arguments.rounds, 1)
    program, problem = built("em_iterations", arguments.release), Linear(arguments.steps)
    log = asami_run(program, LEARNERS[0], 1)
    profile = "release" if arguments.release else "dev"
    ours = {f"asami {name} ({profile})": (lambda n, name=name: asami_run(program, name, n), ASAMI, log["steps"])
            for name in LEARNERS}
    peers = {
        f"pykalman {importlib.metadata.version('pykalman')}": (pykalman_run(problem), PYKALMAN, arguments.steps),
        f"dynamax {importlib.metadata.version('dynamax')}, jit": (dynamax_run(problem), DYNAMAX, arguments.steps),
    }

    spent = {name: [] for name in [*ours, *peers]}
    for _ in range(rounds):
        for name, runs in (ours | peers).items():
            spent[name].append(per_iteration(*runs))

    median = {name: statistics.median(found) for name, found in spent.items()}
    rows = [[name, f"{median[name]:.3f} ({min(found):.3f} to {max(found):.3f})", *(f"{median[name] / median[it]:.1f}" for it in ours)]
            for name, found in spent.items()]
    below = (f"Milliseconds of processor time per iteration and 1000 steps, one thread each, median (least to greatest) of {rounds} rounds. asami: "
             f"{log['steps']} steps, {log['sightings']} sightings of 2 numbers each, {log['actions']} actions; peers: {arguments.steps} steps of "
             f"{STATES} states and {OBSERVED} numbers observed, all of it linear.")
    table(["method", "ms", *(f"times {name}'s" for name in LEARNERS)], rows, below, arguments.table)


if __name__ == "__main__":
    main()
