#!/usr/bin/env python3
"""Makes things go wrong, and checks that each ends with one clear line, its exit status, and earlier files intact.

    faults.py MPM INJECT [--short] [NAME ...]

INJECT is the library made of inject.c; --short takes fewer samples; NAME says which of the checks to make.
"""
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np

from mpm_regression.folders import (ENVIRONMENT, change_sealed, checkpoints, command, contents, differences, faults_of_folder, frames, fresh,
                     is_whole, launcher, rows, run)

HERE = pathlib.Path(__file__).parent
DECK = HERE / "small.opts"
OPTIONS = ("-backend", "serial", "-p2g", "gather", "-time_max_steps", 120)


def not_built(done):
    return "built without" in done.stderr or "compiled in" in done.stderr


class Checks:
    def __init__(self, binary, inject, short):
        self.binary, self.inject, self.short = binary, inject, short
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="mpm_faults_"))
        self.whole = self.base / "whole"
        run(binary, DECK, self.whole, *OPTIONS)
        self.chance = random.Random(3)

    def go(self, folder, *options, **how):
        return run(self.binary, DECK, folder, *OPTIONS, *options, **how)

    def expect_line(self, done, *words):
        """One line on stderr that holds the words."""
        lines = done.stderr.splitlines()
        assert len(lines) == 1 and lines[0].startswith("mpm: "), f"not one line: {done.stderr!r}"
        for word in words:
            assert word in lines[0], f"{word!r} is not in {lines[0]!r}"

    def expect_end(self, folder):
        """From what is left the run ends as if nothing had happened."""
        again = ("-restart", "latest") if checkpoints(folder) else ()
        self.go(folder, *again)
        different = differences(self.whole, folder)
        assert not different, different

    def expect_intact(self, folder):
        faults = faults_of_folder(folder)
        assert not faults, faults

    # --- going on -----------------------------------------------------------------------------------------

    def check_two_halves(self):
        """N + N steps are 2 N, whatever the strategy, the velocity update and where the cut is."""
        count = 0
        for strategy in ("sequential", "mosaic", "gather", "tile"):
            for update in ((), ("-velocity_update", "apic"), ("-velocity_update", "xpic")):
                if self.short and (strategy == "gather") == (update == ()):
                    continue
                options = ("-p2g", strategy, *update)
                one, two = fresh(self.base / "one"), fresh(self.base / "two")
                self.go(one, *options)
                for last in (self.chance.randrange(1, 119), 120):
                    again = ("-restart", "latest") if checkpoints(two) else ()
                    self.go(two, *options, *again, "-time_max_steps", last)
                different = differences(one, two)
                assert not different, (options, different)
                count += 1
        return f"{count} pairs of runs"

    def check_across_rebuilds(self):
        """A restart gives the same bits where a rebuild lies between, in both precisions."""
        one, two = fresh(self.base / "one"), fresh(self.base / "two")
        cuts = (217, 222, 300) if self.short else (217, 222, 580, 900)
        for options in ((), ("-precision", "single")):
            whole = self.go(one, *options, "-time_max_steps", cuts[-1], status=None)
            if not_built(whole):
                continue
            for last in cuts:
                again = ("-restart", "latest") if checkpoints(two) else ()
                self.go(two, *options, *again, "-time_max_steps", last)
            different = differences(one, two)
            assert not different, different
            fresh(two)

    def check_other_machine(self):
        """Another backend, precision or strategy goes on, says so, and stays near."""
        for options in (("-p2g", "tile"), ("-backend", "openmp"), ("-precision", "single"), ("-rebuild_margin", 0.2)):
            folder = fresh(self.base / "other")
            self.go(folder, "-time_max_steps", 60)
            done = self.go(folder, "-restart", "latest", *options, status=None)
            if not_built(done):
                continue
            assert done.returncode == 0 and "same up to round-off" in done.stdout, done.stdout[-2000:] + done.stderr
            ours, theirs = rows(folder), rows(self.whole)
            assert [row[0] for row in ours] == [row[0] for row in theirs]
            x, y = (float(r[-1][r[0].index("plate_y")]) for r in (ours, theirs))
            assert abs(x - y) < 1e-6, (options, x, y)

    def check_same_again(self):
        """A restart from the end changes nothing; one from an earlier checkpoint comes to the same end."""
        folder = self.base / "again"
        shutil.copytree(self.whole, folder)
        self.go(folder, "-restart", "latest")
        assert not differences(self.whole, folder)
        self.go(folder, "-restart", checkpoints(folder)[0])
        assert not differences(self.whole, folder)

    def go_on_ranks(self, ranks, folder, *options, **how):
        return run(self.binary, DECK, folder, *OPTIONS, *options, **how, prefix=launcher(ranks))

    def check_several_ranks(self):
        """Several ranks go on to the same bits too, and another number of ranks goes on up to round-off."""
        go = self.go_on_ranks
        tried, half = ((2,), 125) if self.short else ((2, 3), 200)
        for ranks in tried:
            whole, halves = fresh(self.base / f"whole_{ranks}"), fresh(self.base / f"halves_{ranks}")
            go(ranks, whole, "-time_max_steps", 2 * half)
            go(ranks, halves, "-time_max_steps", half)
            others = self.base / f"other_than_{ranks}"
            shutil.copytree(halves, others)
            done = go(ranks, halves, "-time_max_steps", 2 * half, "-restart", "latest")
            assert "so will be the bits" in done.stdout, done.stdout[-2000:]
            assert not differences(whole, halves), differences(whole, halves)
            done = go(5 - ranks, others, "-time_max_steps", 2 * half, "-restart", "latest")
            assert "same up to round-off" in done.stdout, done.stdout[-2000:]
            ours, theirs = rows(whole), rows(others)
            assert [row[0] for row in ours] == [row[0] for row in theirs]
            x, y = (float(r[-1][r[0].index("stone_y")]) for r in (ours, theirs))
            assert abs(x - y) < 1e-9, (ranks, x, y)
        return f"{' and '.join(map(str, tried))} ranks"

    def check_cuts_before_a_rebuild(self):
        """A rebuild that is due when a run is cut comes at its step, on whatever number of ranks it goes on."""
        whole, last = fresh(self.base / "uncut"), 250 if self.short else 400
        self.go_on_ranks(1, whole, "-time_max_steps", last)
        since = contents(checkpoints(whole)[-1])["@since_rebuild"]
        rebuilt = last - int.from_bytes(since, sys.byteorder)
        assert 50 < rebuilt < last, rebuilt
        pairs = {rebuilt - 1: (1, 2), rebuilt - 2: (2, 1), rebuilt - 3: (2, 3), rebuilt: (3, 2)}
        for cut, (before, behind) in list(pairs.items())[:2 if self.short else 4]:
            folder = fresh(self.base / "cut")
            self.go_on_ranks(before, folder, "-time_max_steps", cut)
            self.go_on_ranks(behind, folder, "-time_max_steps", last, "-restart", "latest")
            ours, theirs = rows(folder), rows(whole)
            x, y = (float(r[-1][r[0].index("stone_y")]) for r in (ours, theirs))
            assert abs(x - y) < 1e-12, (cut, before, behind, x, y)
        return f"a rebuild at step {rebuilt}"

    def check_restarts_of_ranks(self):
        """A restart from a checkpoint that a restart has written, and so on: every one from the last but one."""
        whole, folder = fresh(self.base / "whole_of_ranks"), fresh(self.base / "again_and_again")
        self.go_on_ranks(2, whole, "-time_max_steps", 200)
        for last in (75, 105, 165, 200):
            again = ("-restart", checkpoints(folder)[0]) if checkpoints(folder) else ()
            self.go_on_ranks(2, folder, *again, "-time_max_steps", last)
        steps = {row[0] for row in rows(whole)}  # the ends of runs have rows and frames of their own
        assert [row for row in rows(folder) if row[0] in steps] == rows(whole)
        items = ("soil", "rigids", "impulse", "bound")
        one, two = (contents(checkpoints(each)[-1]) for each in (whole, folder))
        different = [key for key in one if key.lstrip("@").startswith(items) and one[key] != two.get(key)]
        assert not different, different

    def check_frames_of_ranks(self):
        """Frames hold the same whatever the number of ranks, and compressed ones the same bits as others."""
        options = ("-output_nodes", "on", "-output_interval", 4e-3)
        alone, tried = None, (1, 2) if self.short else (1, 2, 3)
        for ranks in tried:
            plain, packed = fresh(self.base / "plain"), fresh(self.base / "packed")
            self.go_on_ranks(ranks, plain, *options)
            self.go_on_ranks(ranks, packed, *options, "-output_compression", 1)
            assert len(frames(plain)) > 3 and not differences(plain, packed), differences(plain, packed)
            here = [contents(path) for path in frames(plain)]
            alone = alone or here
            for k, (one, other) in enumerate(zip(alone, here, strict=True)):
                assert one.keys() == other.keys(), one.keys() ^ other.keys()
                for key in one:
                    if "/" not in key or "@" in key:  # time, step, units
                        assert one[key] == other[key], (ranks, key)
                        continue
                    assert one[key][:2] == other[key][:2], (ranks, key, one[key][:2], other[key][:2])
                    a, b = (np.frombuffer(of[key][2], of[key][1]) for of in (one, other))
                    apart = np.abs(a - b).max() / max(np.abs(a).max(), 1e-300)
                    assert apart <= (0 if k == 0 and "soil" in key else 1e-9), (ranks, k, key, apart)
        return f"{' and '.join(map(str, tried))} ranks"

    def check_other_folder(self):
        """A checkpoint of another folder brings its rows along."""
        folder = fresh(self.base / "elsewhere")
        self.go(folder, "-restart", checkpoints(self.whole)[0])
        assert rows(folder) == rows(self.whole)

    def check_signals(self):
        """Each signal ends the run with a checkpoint and 75; from there it ends as if it had not come."""
        for sent in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            folder = fresh(self.base / "printed")
            process = subprocess.Popen(command(self.binary, DECK, folder, *OPTIONS, "-checkpoint_interval", 10,
                                               "-history_interval", 1e-5), env=ENVIRONMENT,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while not (folder / "history.csv").exists() and process.poll() is None:
                time.sleep(0.001)
            process.send_signal(sent)
            printed, _ = process.communicate(timeout=60)
            if process.returncode == 0:
                raise AssertionError("the run ended before the signal came")
            assert process.returncode == 75 and sent.name in printed, (process.returncode, printed[-500:])
            assert len(checkpoints(folder)) == 1
            self.go(folder, "-restart", "latest", "-checkpoint_interval", 10, "-history_interval", 1e-5)
            assert len(rows(folder)) == 122

    def check_second_signal(self):
        """A second signal ends the program at once. It is stopped in between, lest it be done before; on a busy machine it may be so all the same."""
        ended, least, most = [], 4 if self.short else 8, 24
        while len(ended) < least or (-signal.SIGTERM not in ended and len(ended) < most):
            folder = fresh(self.base / "twice")
            process = subprocess.Popen(command(self.binary, DECK, folder, *OPTIONS, "-mesh_spacing", 0.02, "-time_step", 5e-5,
                                               "-checkpoint_interval", 10), env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            while not (folder / "history.csv").exists() and process.poll() is None:
                time.sleep(0.001)
            for sent, wait in ((signal.SIGTERM, 0.002), (signal.SIGSTOP, 0.1), (signal.SIGTERM, 0), (signal.SIGCONT, 0)):
                process.send_signal(sent)
                time.sleep(wait)
            ended.append(process.wait(timeout=60))
            assert not faults_of_folder(folder)
        assert set(ended) <= {-signal.SIGTERM, 75} and -signal.SIGTERM in ended, ended
        return f"{ended.count(-signal.SIGTERM)} of {len(ended)} were still running"

    def check_wall_time_limit(self):
        """A chain of runs that each stop at the limit ends as one that does not."""
        whole, folder, runs = self.base / "few", fresh(self.base / "chain"), 0
        self.go(whole, "-time_max_steps", 8)
        while True:
            again = ("-restart", "latest") if checkpoints(folder) else ()
            done = self.go(folder, *again, "-time_max_steps", 8, "-wall_time_limit", 1e-3, status=None)
            runs += 1
            if done.returncode == 0:
                break
            assert done.returncode == 75, done.stderr
        assert runs > 2 and not differences(whole, folder), runs
        return f"{runs} runs"

    def check_contradictions(self):
        """A change that contradicts the state is refused by name, and nothing is touched."""
        folder = self.base / "refused"
        shutil.copytree(self.whole, folder)
        before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        for option, value in (("-gravity", "0,-9"), ("-mesh_spacing", "0.05"), ("-clay_su", "900"), ("-time_step", "1e-4"),
                              ("-plate_velocity", "0,-1"), ("-soil_particles_per_cell", "3"), ("-f_bar_fraction", "0"),
                              ("-plate_friction", "0.2"), ("-time_end", "1e-3"), ("-time_max_steps", "7"),
                              ("-velocity_update", "pic"), ("-mesh_ymax", "roller")):
            done = self.go(folder, "-restart", "latest", option, value, status=2)
            self.expect_line(done, option)
        for path, text in before.items():
            assert path.read_bytes() == text, f"{path} was touched"

    def check_dry_run(self):
        """Tells what the run takes, and writes nothing."""
        folder = fresh(self.base / "dry")
        done = self.go(folder, "-dry_run")
        for word in ("particles     640", "memory", "time step     0.0002", "steps         120", "output", "wall time"):
            assert word in done.stdout, word
        assert not folder.exists()

    def check_sweep(self):
        """A table of runs comes to one file and one picture; the same command again makes nothing anew."""
        folder, table = fresh(self.base / "sweep"), self.base / "table.csv"
        table.write_text('clay_su,plate_velocity\n800,"0.5,-1"\n1200,"0,-1"\n')
        words = [sys.executable, HERE.parent.parent / "scripts/sweep", table, "-options_file", DECK, "-backend", "serial",
                 "-p2g", "tile", "-time_max_steps", "40", "--mpm", self.binary, "--out", folder]
        for printed in ("finished", "finished before"):
            done = subprocess.run(list(map(str, words)), env=ENVIRONMENT, capture_output=True, text=True)
            assert done.returncode == 0 and done.stdout.count(printed) == 2, done.stdout + done.stderr
        lines = (folder / "histories.csv").read_text().splitlines()
        assert lines[0].startswith("run,clay_su,plate_velocity,step,time") and lines[-1].startswith("1,1200,")
        assert len(lines) == 1 + sum(len(rows(folder / f"run_000{n}")) - 1 for n in (0, 1))
        assert (folder / "sweep.png").stat().st_size > 5000

    # --- damaged checkpoints ------------------------------------------------------------------------------

    def check_damaged_checkpoint(self):
        """A checkpoint that is cut, or has a wrong byte anywhere, is passed over; the one before is taken."""
        flips, cuts, folder = 6 if self.short else 40, 3 if self.short else 20, self.base / "damaged"
        sound = checkpoints(self.whole)[-1].read_bytes()
        for n in range(flips + cuts):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(self.whole, folder)
            data = bytearray(sound)
            if n < flips:
                at = self.chance.randrange(len(data))
                data[at] ^= 1 << self.chance.randrange(8)
            else:
                at = self.chance.randrange(len(data))
                del data[at:]
            latest = checkpoints(folder)[-1]
            latest.write_bytes(data)
            self.expect_line(self.go(folder, "-restart", latest, status=2), "-restart", latest.name, "takes")
            if n % 10 == 0:
                done = self.go(folder, "-restart", "latest")
                assert "is passed over" in done.stdout
                assert not differences(self.whole, folder)
        return f"{flips} flipped bits, {cuts} cuts"

    def check_mischievous_checkpoint(self):
        """A checkpoint whose seal is right and whose numbers cannot be: one line, nothing touched."""
        folder = self.base / "mischief"
        for name, value in (("frames", 10**12), ("frames", -1), ("step", -5), ("since_rebuild", -1), ("history_bytes", -1),
                            ("history_bytes", 10**17), ("bound", np.nan), ("bound", 1e300), ("time", np.inf)):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(self.whole, folder)
            latest = checkpoints(folder)[-1]
            change_sealed(latest, lambda file: file.attrs.modify(name, np.asarray(value, file.attrs[name].dtype)))
            assert is_whole(latest)
            self.expect_line(self.go(folder, "-restart", latest, status=2), "takes")
            assert rows(folder) == rows(self.whole), name

    def check_no_checkpoint(self):
        """Rubbish, a frame, a folder, nothing: one line, nothing touched."""
        rubbish = self.base / "rubbish.h5"
        rubbish.write_bytes(self.chance.randbytes(5000))
        empty = self.base / "empty.h5"
        empty.write_bytes(b"")
        for file in (rubbish, empty, frames(self.whole)[0], self.base, self.base / "none.h5"):
            folder = fresh(self.base / "nothing")
            self.expect_line(self.go(folder, "-restart", file, status=2), "-restart")
            assert not folder.exists()
        self.expect_line(self.go(fresh(self.base / "nothing"), "-restart", "latest", status=2), "has none")

    def check_other_history(self):
        """A history that is not that of the checkpoint is not cut."""
        folder = self.base / "history"
        shutil.copytree(self.whole, folder)
        path = folder / "history.csv"
        text = path.read_text().replace("e-05", "e-06", 1)
        path.write_text(text)
        self.expect_line(self.go(folder, "-restart", "latest", status=2), "-output_dir", "history.csv")
        assert path.read_text() == text

    # --- the system ---------------------------------------------------------------------------------------

    def check_full_disk(self):
        """A file system of 200 to 700 kB."""
        point = self.base / "disk"
        point.mkdir()
        tried = 0
        ways = [(self.go, ()), (lambda *words, **how: self.go_on_ranks(2, *words, **how), ("-output_compression", 1))]
        for number, size in enumerate((130, 280) if self.short else (60, 130, 200, 280, 360, 440)):
            for go, options in ways[number:number + 1] if self.short else ways:
                if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", point],
                                  capture_output=True).returncode != 0:
                    return "left out: no file system can be mounted here; injected faults do the same"
                try:
                    folder = point / "out"
                    done = go(folder, *options, status=1)
                    printed = [line for line in done.stderr.splitlines() if line.startswith("mpm: ")]  # mpirun prints more
                    assert len(printed) == 1 and "No space left on device" in printed[0] and str(folder) in printed[0], done.stderr
                    self.expect_intact(folder)
                    kept = self.base / "kept"
                    shutil.rmtree(kept, ignore_errors=True)
                    shutil.copytree(folder, kept)
                    if go == self.go:
                        self.expect_end(kept)
                    else:
                        go(kept, *options, *(("-restart", "latest") if checkpoints(kept) else ()))
                    tried += 1
                finally:
                    subprocess.run(["umount", point], check=True)
        return f"{tried} times, on 1 and 2 ranks"

    def check_injected_faults(self):
        """Calls of the system that fail, one after another through the run."""
        tried, seen = 0, {}
        for call, error, word in (("write", 28, "No space left"), ("write", 5, "Input/output error"),
                                  ("fsync", 5, "Input/output error"), ("fsync", 28, "No space left"),
                                  ("rename", 13, "Permission denied"), ("open", 13, "Permission denied"),
                                  ("open", 30, "Read-only")):
            folder, count = fresh(self.base / "injected"), self.base / "count"
            setting = {"LD_PRELOAD": self.inject, "INJECT_FOLDER": str(folder), "INJECT_CALL": call,
                       "INJECT_ERRNO": str(error), "INJECT_PART": "0.4"}
            if call not in seen:
                count.write_bytes(b"")
                self.go(folder, environment={**setting, "INJECT_COUNT": str(count)})
                seen[call] = count.stat().st_size
            calls = seen[call]
            assert calls > 10, f"{call} was seen {calls} times"
            for after in sorted(self.chance.sample(range(calls), 1 if self.short else 8)):
                fresh(folder)
                done = self.go(folder, environment={**setting, "INJECT_AFTER": str(after)}, status=1)
                self.expect_line(done, word, str(folder))
                if folder.exists():
                    self.expect_intact(folder)
                    assert not list(folder.rglob("*.tmp")) or call == "open", list(folder.rglob("*.tmp"))
                self.expect_end(folder)
                tried += 1
        return f"{tried} failing calls"

    def check_unwritable_folder(self):
        """A folder that cannot be made or written into."""
        blocked = self.base / "file"
        blocked.write_text("in the way")
        for folder in ("/proc/mpm", blocked, blocked / "below"):
            self.expect_line(self.go(folder, status=1), str(folder))
        assert blocked.read_text() == "in the way"

    # --- the user and the computation ---------------------------------------------------------------------

    def check_rubbish_options(self):
        """An options file with bytes of rubbish."""
        for n in range(4 if self.short else 20):
            file = self.base / "rubbish.opts"
            text = bytearray(DECK.read_bytes())
            for _ in range(20):
                text[self.chance.randrange(len(text))] = self.chance.randrange(256)
            file.write_bytes(text if n else self.chance.randbytes(3000))
            folder = fresh(self.base / "rubbish")
            done = run(self.binary, file, folder, "-backend", "serial", "-time_max_steps", 3, status=None)
            assert done.returncode in (0, 2, 3), (done.returncode, done.stderr)
            if done.returncode == 2:
                assert done.stderr.startswith("mpm: ") and not folder.exists()

    def check_failing_computation(self):
        """A particle that is too fast, soil that is alone, and a rigid that leaves: status 3, and what was written is whole."""
        for words, options in (("moved more than a cell", ("-soil_velocity", "1e6,1e6")),
                               ("is alone", ("-soil_velocity", "0,30", "-stray_particles", "stop", "-stone_contact", "nodes")),
                               ("rigid plate", ("-plate_velocity", "20,1", "-rigid_contact", "off"))):
            folder = fresh(self.base / "failing")
            done = run(self.binary, DECK, folder, "-backend", "serial", *options, status=3)
            assert words in done.stderr, done.stderr
            self.expect_line(done, "step", "time")
            self.expect_intact(folder)


def main():
    words = [word for word in sys.argv[1:] if word != "--short"]
    binary, inject, *names = words
    checks = Checks(binary, inject, short=len(words) < len(sys.argv) - 1)
    for name in names or [name[6:] for name in dir(checks) if name.startswith("check_")]:
        began = time.time()
        try:
            result = getattr(checks, "check_" + name)()
        except AssertionError as error:
            sys.exit(f"{name}: {error}\n(files are in {checks.base})")
        print(f"{name:24} {time.time() - began:6.1f} s  {result or 'as it should be'}", flush=True)
    shutil.rmtree(checks.base)


if __name__ == "__main__":
    main()
