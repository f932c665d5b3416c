#!/usr/bin/env python3
"""Withheld cases of another program: the plain robot of scenarios/plain_2d.toml, simulated anew in plain Python.

    cargo run --bin generate scenarios/plain_2d.toml --seed 1000 -o results/plain_nominal
    python3 benches/peers/kinematic_cases.py results/plain_nominal -o results/foreign_plain
    cargo run --bin sweep scenarios/blind_foreign.toml

It shares no code, no random numbers and no drive with asami's simulator: of the nominal data set it takes the
landmarks and the surveyed velocities of the 40 actions, everything else from section 4.4.2 of D. Stronger (2008). It
writes the layout of `generate --withhold`: cases/NNN (version 1, no truth) and keys/NNN (key.toml, truth.csv).
Effects are its own: eleven that the catalogue has names for, and five (`unlisted` in a key) that it has none for.
Needs Python 3.11 or later and nothing else.
"""

import argparse
import hashlib
import math
import pathlib
import random
import sys
import tomllib

STEP_S = 0.05
# Section 2.5.1: a beacon of 200 mm, 191.943 px of focal length; the camera ahead of the body's centre.
HEIGHT_PX_M, CAMERA_AHEAD_M, LOST_PX = 38.3887, 0.1, 1.0
SIGMA_PX, SIGMA_RAD = 1.0, 0.5
NEAR_M, FAR_M = 1.275, 4.175
VIEW_RAD, SCAN_RAD, SCAN_S, RECOGNISED = 0.9931, 1.4, 2.0, 0.86
# The field of 3.6 m x 5.4 m, less a margin.
HALF_FIELD_M = (1.5, 2.4)
GREATEST = (0.35, 0.4, 3.0)


def actions():
    """Equations 4.29 to 4.31: attempted velocities by id 8 k_omega + k_psi."""
    for omega in (-1 / 2, -1 / 6, 0.0, 1 / 6, 1 / 2):
        across = math.sqrt(1 - omega * omega)
        for k in range(8):
            psi = k * math.pi / 4
            yield (GREATEST[0] * across * math.cos(psi), GREATEST[1] * across * math.sin(psi), GREATEST[2] * omega)


def wrap(angle):
    wrapped = (angle + math.pi) % (2 * math.pi) - math.pi
    return -math.pi if wrapped >= math.pi else wrapped


def log_uniform(rng, least, greatest):
    return least * math.exp(rng.random() * math.log(greatest / least))


def either(rng, size):
    return size if rng.random() < 0.5 else -size


# What the catalogue has a name for: its parameters, drawn.
LISTED = {
    "command_delay": lambda rng: {"delay_s": log_uniform(rng, 0.03, 0.2)},
    "command_scale": lambda rng: dict.fromkeys(
        ("x_ratio", "y_ratio", "theta_ratio"), 1 + either(rng, log_uniform(rng, 0.03, 0.25))
    ),
    "slope": lambda rng: {
        "pitch_rad": either(rng, log_uniform(rng, 0.015, 0.1)),
        "uphill_rad": rng.choice((0.0, math.pi / 2)),
    },
    "focal_error": lambda rng: {"ratio": 1 + either(rng, log_uniform(rng, 0.02, 0.12))},
    "pan_offset": lambda rng: {"offset_rad": either(rng, log_uniform(rng, 0.04, 0.25))},
    "image_delay": lambda rng: {"delay_s": log_uniform(rng, 0.02, 0.15)},
    "height_bias": lambda rng: {"bias_px": either(rng, log_uniform(rng, 0.2, 3.0))},
    "vision_noise": lambda rng: {"ratio": 1 + log_uniform(rng, 0.08, 0.5)},
    "missed_sightings": lambda rng: {"share": log_uniform(rng, 0.06, 0.6)},
    "false_sightings": lambda rng: {"share": log_uniform(rng, 0.003, 0.1)},
    "landmark_moved": lambda rng: {
        "distance_m": either(rng, log_uniform(rng, 0.1, 0.8)),
        "towards_rad": rng.choice((0.0, math.pi / 2)),
        "number": rng.randrange(4),
    },
}

# What it has none for: place, flexible block, size.
UNLISTED = {
    "limp": ("actuation", "static_motion", lambda rng: log_uniform(rng, 0.1, 0.5)),
    "sluggish": ("actuation", "timing", lambda rng: log_uniform(rng, 0.1, 0.6)),
    "fading": ("actuation", "drift", lambda rng: log_uniform(rng, 0.1, 0.5)),
    "tall_beacon": ("scene", "sensor", lambda rng: log_uniform(rng, 0.05, 0.4)),
    "gusts": ("dynamics", "noise", lambda rng: log_uniform(rng, 0.5, 3.0)),
}


class Robot:
    """The robot on its field, with what is planted in it."""

    def __init__(self, nominal, listed, unlisted, duration_s, rng):
        self.velocities, self.motion_sd, self.landmarks = nominal
        self.listed, self.unlisted = listed, unlisted
        self.duration_s, self.rng = duration_s, rng
        self.pose = (0.0, 0.3 * (2 * rng.random() - 1), 0.0)
        self.velocity = (0.0, 0.0, 0.0)
        self.track, self.commands, self.frames, self.sightings = [], [], [], []

    def of(self, effect, parameter, null=0.0):
        return self.listed.get(effect, {}).get(parameter, null)

    def drive(self):
        attempts = list(actions())
        delay_s = self.of("command_delay", "delay_s")
        until_s = 0.0
        for k in range(round(self.duration_s / STEP_S) + 1):
            t_s = k * STEP_S
            self.track.append((t_s, *self.pose))
            self.look(t_s)
            if k * STEP_S >= until_s - 1e-9:
                hold_s = STEP_S * self.rng.randrange(60, 121)
                action = self.choose(attempts, hold_s)
                self.commands.append((t_s, action))
                until_s += hold_s
            in_force = [action for since_s, action in self.commands if since_s + delay_s <= t_s + 1e-9]
            self.move(t_s, in_force[-1] if in_force else None)

    def choose(self, attempts, hold_s):
        """Any action that should stay on the field; else the one that ends nearest to its middle."""
        x_m, y_m, theta = self.pose

        def beyond(attempt):
            ax, ay, turn = attempt
            at, worst = [x_m, y_m], 0.0
            for i in range(10):
                heading = theta + turn * hold_s * (i + 0.5) / 10
                at[0] += (ax * math.cos(heading) - ay * math.sin(heading)) * hold_s / 10
                at[1] += (ax * math.sin(heading) + ay * math.cos(heading)) * hold_s / 10
                worst = max(worst, abs(at[0]) - HALF_FIELD_M[0], abs(at[1]) - HALF_FIELD_M[1])
            return worst

        costs = [beyond(attempt) for attempt in attempts]
        inside = [i for i, cost in enumerate(costs) if cost <= 0.0]
        return self.rng.choice(inside) if inside else min(range(len(costs)), key=costs.__getitem__)

    def wanted(self, t_s, action):
        """What the motors do under an action, on a level floor."""
        if action is None:
            return (0.0, 0.0, 0.0)
        vx, vy, turn = self.velocities[action]
        if "limp" in self.unlisted and vx < 0.0:
            vx *= 1 - self.unlisted["limp"]
        ratio = self.of("command_scale", "y_ratio", 1.0)
        ratio *= 1 - self.unlisted.get("fading", 0.0) * t_s / self.duration_s
        return (vx * ratio, vy * ratio, turn * ratio)

    def move(self, t_s, action):
        wanted = self.wanted(t_s, action)
        lag_s = self.unlisted.get("sluggish")
        share = 1.0 if lag_s is None else 1 - math.exp(-STEP_S / lag_s)
        self.velocity = tuple(v + share * (w - v) for v, w in zip(self.velocity, wanted))
        x_m, y_m, theta = self.pose
        vx, vy, turn = self.velocity
        # Every step slides downhill: twice its length times the sine of the slope.
        slid = 2 * math.hypot(vx, vy) * math.sin(self.of("slope", "pitch_rad"))
        uphill = self.of("slope", "uphill_rad")
        down_x, down_y = slid * math.sin(uphill), -slid * math.cos(uphill)
        gust = 1 + self.unlisted.get("gusts", 0.0)
        right, forward, turned = (self.rng.gauss(0.0, sd * gust) for sd in self.motion_sd)
        right, forward, turned = right + vx * STEP_S, forward + vy * STEP_S, turned + turn * STEP_S
        sin, cos = math.sin(theta), math.cos(theta)
        self.pose = (
            x_m + right * cos - forward * sin + down_x * STEP_S,
            y_m + right * sin + forward * cos + down_y * STEP_S,
            wrap(theta + turned),
        )

    def at(self, t_s):
        """The pose at a time within the track, evenly between steps."""
        place = min(max(t_s / STEP_S, 0.0), len(self.track) - 1.0)
        k = min(int(place), len(self.track) - 1)
        _, x0, y0, theta0 = self.track[k]
        _, x1, y1, theta1 = self.track[min(k + 1, len(self.track) - 1)]
        part = place - k
        return x0 + part * (x1 - x0), y0 + part * (y1 - y0), theta0 + part * wrap(theta1 - theta0)

    def look(self, t_s):
        exposed_s = t_s - self.of("image_delay", "delay_s")
        x_m, y_m, theta = self.at(exposed_s)
        pan = SCAN_RAD * math.sin(2 * math.pi * exposed_s / SCAN_S)
        reading = SCAN_RAD * math.sin(2 * math.pi * t_s / SCAN_S) + self.of("pan_offset", "offset_rad")
        self.frames.append((t_s, wrap(reading)))
        noise = self.of("vision_noise", "ratio", 1.0)
        seen = {}
        for number, (landmark, at_x, at_y) in enumerate(self.landmarks):
            if number == self.of("landmark_moved", "number", None):
                towards, far = self.of("landmark_moved", "towards_rad"), self.of("landmark_moved", "distance_m")
                at_x, at_y = at_x - far * math.sin(towards), at_y + far * math.cos(towards)
            dx, dy = at_x - x_m, at_y - y_m
            distance_m = math.hypot(dx, dy)
            off = wrap(math.atan2(-dx, dy) - theta - pan)
            focal = self.of("focal_error", "ratio", 1.0)
            # A pinhole of another focal length than the vision believes.
            read = math.atan(focal * math.tan(off)) if abs(off) < math.pi / 2 else off
            tall = 1 + self.unlisted.get("tall_beacon", 0.0) if number == 2 else 1.0
            height = HEIGHT_PX_M / (distance_m - CAMERA_AHEAD_M) * focal * tall - LOST_PX
            height += self.of("height_bias", "bias_px") + self.rng.gauss(0.0, SIGMA_PX * noise)
            bearing = wrap(reading + read + self.rng.gauss(0.0, SIGMA_RAD * noise))
            recognised = self.rng.random() < RECOGNISED
            missed = self.rng.random() < self.of("missed_sightings", "share")
            in_view = abs(read) <= VIEW_RAD / 2 and NEAR_M <= distance_m <= FAR_M
            if recognised and in_view and not missed and height > 0.0:
                seen[landmark] = (height, bearing)
        if self.rng.random() < self.of("false_sightings", "share"):
            ends = [HEIGHT_PX_M / (d - CAMERA_AHEAD_M) - LOST_PX for d in (FAR_M, NEAR_M)]
            far = self.rng.random()
            height = 1 / (far / ends[0] + (1 - far) / ends[1])
            seen[self.rng.choice(self.landmarks)[0]] = (height, wrap(reading + VIEW_RAD * (self.rng.random() - 0.5)))
        self.sightings += [(t_s, landmark, *seen[landmark]) for landmark in sorted(seen)]


def plant(rng):
    """None in three of ten cases, one listed in four, two in one, one that nobody has listed in two."""
    share = rng.random()
    names = [] if share < 0.3 else rng.sample(sorted(LISTED), 2 if share > 0.9 else 1)
    if 0.7 <= share <= 0.9:
        name = rng.choice(sorted(UNLISTED))
        return {}, {name: UNLISTED[name][2](rng)}
    return {name: LISTED[name](rng) for name in names}, {}


def table(path, head, rows):
    lines = [",".join(str(value) for value in row) for row in rows]
    path.write_text("\n".join([head, *lines]) + "\n")


def write(robot, known, seed, case, key):
    attempts = list(actions())
    for folder in (case, key):
        folder.mkdir(parents=True)
        (folder / "dataset.toml").write_text(known)
    table(
        case / "commands.csv",
        "t_s,action,ax_m_per_s,ay_m_per_s,atheta_rad_per_s",
        [(t_s, action, *attempts[action]) for t_s, action in robot.commands],
    )
    table(case / "frames.csv", "t_s,head_pan_rad", robot.frames)
    table(case / "sightings.csv", "t_s,landmark,height_px,bearing_rad", robot.sightings)
    table(key / "truth.csv", "t_s,x_m,y_m,theta_rad", robot.track)
    text = f'schema = 1\nnominal = "plain_2d"\nduration_s = {robot.duration_s}\nseed = {seed}\n'
    for name, size in robot.unlisted.items():
        place, block, _ = UNLISTED[name]
        text += f'\n[[unlisted]]\nname = "{name}"\nplace = "{place}"\nblock = "{block}"\nsize = {size}\n'
    for name, parameters in robot.listed.items():
        text += f"\n[effects.{name}]\n" + "".join(f"{key} = {value}\n" for key, value in parameters.items())
    (key / "key.toml").write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nominal", type=pathlib.Path, help="a data set of the nominal world, with its survey")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="the folder to write")
    parser.add_argument("--cases", type=int, default=48)
    parser.add_argument("--salt", default="release 0.1", help="what every draw follows from")
    parser.add_argument("--duration-s", type=float, default=150.0)
    asked = parser.parse_args()
    if asked.output.exists():
        sys.exit(f"{asked.output} is there already: remove it, or give another folder")
    landmarks = tomllib.loads((asked.nominal / "dataset.toml").read_text())["landmarks"]
    survey = tomllib.loads((asked.nominal / "survey.toml").read_text())
    of_action = {it["action"]: it for it in survey["velocity_by_action"]}
    velocities = [
        tuple(of_action[i][name] for name in ("vx_m_per_s", "vy_m_per_s", "vtheta_rad_per_s")) for i in range(40)
    ]
    nominal = (velocities, survey["motion_sd"], [(it["id"], it["x_m"], it["y_m"]) for it in landmarks])
    known = 'schema = 1\nrobot = "plain"\nnominal = "plain_2d"\ncommand_rate_hz = 20.0\n' + "".join(
        "\n[[landmarks]]\n" + "".join(f"{key} = {value}\n" for key, value in it.items()) for it in landmarks
    )
    width = max(3, len(str(asked.cases)))
    for number in range(1, asked.cases + 1):
        digest = hashlib.sha256(f"asami foreign case/{asked.salt}/{number}".encode()).digest()
        # TOML's integers have a sign.
        seed = int.from_bytes(digest[:8], "big") >> 1
        rng = random.Random(seed)
        listed, unlisted = plant(rng)
        robot = Robot(nominal, listed, unlisted, asked.duration_s, rng)
        robot.drive()
        name = f"{number:0{width}d}"
        write(robot, known, seed, asked.output / "cases" / name, asked.output / "keys" / name)
    (asked.output / "keys" / "salt.toml").write_text(f'salt = "{asked.salt}"\ncases = {asked.cases}\n')
    print(asked.output)


if __name__ == "__main__":
    main()
