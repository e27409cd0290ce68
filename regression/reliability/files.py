#!/usr/bin/env python3
"""Damage by users, other runs and the system to a run's files: each ends with one clear line and its exit status, nothing lost.

    files.py MPM INJECT [--short] [NAME ...]

INJECT is the library made of inject.c; --short takes fewer samples; NAME says which of the checks to make.
"""
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

from mpm_regression.folders import (ENVIRONMENT, change_sealed, checkpoints, command, differences, faults_of_folder, frames, fresh, is_whole,
                     launcher, rows, run)

HERE = pathlib.Path(__file__).parent
DECK = HERE / "small.opts"
OPTIONS = ("-backend", "serial", "-p2g", "gather", "-time_max_steps", 120)
RANKS = launcher(2)
PATIENCE = 120  # s, for what must not wait for ever


def everything(folder):
    """All files of a folder with what is in them."""
    return {path: path.read_bytes() for path in pathlib.Path(folder).rglob("*") if path.is_file()}


class Checks:
    def __init__(self, binary, inject, short):
        self.binary, self.inject, self.short = binary, inject, short
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="mpm_files_"))
        self.whole = self.base / "whole"
        run(binary, DECK, self.whole, *OPTIONS)
        self.listed = self.base / "listed.opts"  # the soil is that of a file
        lines = [line for line in DECK.read_text().splitlines() if not line.startswith(("-soil_shape", "-soil_lower", "-soil_upper",
                                                                                        "-soil_stress"))]
        self.listed.write_text("\n".join([*lines, "-soil_shape particles"]) + "\n")
        self.endless = ("-time_max_steps", 10**7, "-time_end", 1e3, "-history_interval", 5e-4, "-output_interval", 0.005)
        self.no_checkpoints = self.base / "no_checkpoints.opts"
        self.no_checkpoints.write_text("".join(line for line in DECK.read_text().splitlines(True)
                                               if not line.startswith("-checkpoint_interval")))
        self.chance = random.Random(5)

    def go(self, folder, *options, status=0, deck=DECK, prefix=(), limit=None, environment=None):
        words = [*prefix, *command(self.binary, deck, folder, *OPTIONS, *options)]
        done = subprocess.run(words, env={**ENVIRONMENT, **(environment or {})}, capture_output=True, text=True,
                              errors="replace", timeout=PATIENCE, preexec_fn=limit)
        assert status is None or done.returncode == status, (done.returncode, words, done.stdout[-800:], done.stderr)
        return done

    def expect_line(self, done, *words):
        """One line of ours on stderr that holds the words; a launcher may add its own."""
        lines = [line for line in done.stderr.splitlines() if line.startswith("mpm: ") or done.args[0] != RANKS[0]]
        assert len(lines) == 1 and lines[0].startswith("mpm: "), f"not one line: {done.stderr!r}"
        for word in words:
            assert str(word) in lines[0], f"{word!r} is not in {lines[0]!r}"

    def copy_of_whole(self, name):
        folder = fresh(self.base / name)
        shutil.copytree(self.whole, folder)
        return folder

    def start(self, folder, *options, prefix=()):
        """A run in the background that has taken its folder and is under way."""
        process = subprocess.Popen([*prefix, *command(self.binary, DECK, folder, *OPTIONS, *options)], env=ENVIRONMENT,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (folder / "history.csv").exists() and process.poll() is None:
            time.sleep(0.001)
        return process

    # --- inputs and files of others -------------------------------------------------------------------------

    def check_own_input(self):
        """A run that would remove its own input is refused before anything is touched, by whatever path it is named."""
        folder = self.copy_of_whole("own_input")
        frame = folder / "frames/frame_00000.h5"
        linked = self.base / "linked.h5"
        os.link(frame, linked)
        deck = folder / "particles.xdmf"
        shutil.copy(DECK, deck)
        before = everything(folder)
        for file in (frame, folder / "frames/../frames/frame_00000.h5", linked):
            for how in ((), ("-dry_run",)):
                done = self.go(folder, "-soil_file", file, *how, deck=self.listed, status=2)
                self.expect_line(done, "-soil_file", file, "takes a file that this run does not remove")
        self.expect_line(self.go(folder, deck=deck, status=2), "-options_file", deck, "takes a file that this run does not remove")
        self.expect_line(self.go(folder, "-soil_file", frame, deck=self.listed, status=2, prefix=RANKS), "-soil_file", frame)
        assert everything(folder) == before
        self.go(self.base / "elsewhere", "-soil_file", frame, deck=self.listed)  # another folder is free to

    def check_files_of_others(self):
        """Names like ours stay; under a name of ours a file of others is an error, in a new run and in one that goes on."""
        folder = self.copy_of_whole("others")
        mine = [folder / name for name in ("checkpoint_notes.h5", "frames/frame_mine.h5", "checkpoint_1.h5.bak", "notes.csv")]
        for path in mine:
            path.write_text("mine")
        self.go(folder)
        self.go(folder, "-restart", "latest")
        assert all(path.read_text() == "mine" for path in mine)
        mine[1].unlink()
        assert not differences(self.whole, folder), differences(self.whole, folder)
        with h5py.File(folder / "frames/frame_99999.h5", "w") as file:
            file["weights"] = np.arange(5)
        before = everything(folder)
        for again in ((), ("-restart", "latest")):
            self.expect_line(self.go(folder, *again, status=2), "-output_dir", "frame_99999.h5", "is not the program's")
        assert everything(folder) == before
        (folder / "frames/frame_99999.h5").unlink()
        for name in ("history.csv", "mpm.log", "options.json", "performance.json", "particles.xdmf", "partition.csv", "checkpoint_77.h5"):
            folder = fresh(self.base / "others")
            folder.mkdir()
            (folder / name).write_text("mine")
            self.expect_line(self.go(folder, status=2), "-output_dir", name)
            assert [path.name for path in folder.iterdir()] == [name] and (folder / name).read_text() == "mine"

    def performance(self, folder):
        """outcome, first_step and steps of a performance.json."""
        printed = json.loads((folder / "performance.json").read_text())
        assert bool(printed["functions"]) == (printed["steps"] > 0) and (printed["particle_updates_per_second"] or 1) > 0, printed
        return printed["outcome"], printed["first_step"], printed["steps"]

    def check_performance(self):
        """performance.json is that of the last run that ended here, or is absent: of each part of a run its own."""
        assert self.performance(self.whole) == ("finished", 0, 120)
        folder = fresh(self.base / "performance")
        self.go(folder, "-time_max_steps", 50)
        self.go(folder, "-restart", "latest", prefix=RANKS)
        outcome, first, steps = self.performance(folder)
        assert (outcome, first + steps) == ("finished", 120) and first > 0, (first, steps)
        assert json.loads((folder / "performance.json").read_text())["between_ranks"]["particles"]["mean"] > 0
        self.go(folder, "-restart", "latest")
        assert self.performance(folder) == ("finished", 120, 0)
        process = self.start(folder, *self.endless, "-restart", "latest")
        while (folder / "performance.json").exists() and process.poll() is None:
            time.sleep(0.001)
        process.kill()
        process.communicate()
        assert not (folder / "performance.json").exists()
        folder = fresh(folder)
        process = self.start(folder, *self.endless)
        process.terminate()
        process.communicate(timeout=PATIENCE)
        assert process.returncode == 75 and self.performance(folder)[0] == "stopped"
        self.go(folder, "-plate_velocity", "20,1", "-time_max_steps", 5000, status=3)
        assert self.performance(folder)[:2] == ("failed", 0)
        (folder / "performance.json").write_text("{}")
        for again in ((), ("-restart", "latest")):
            self.expect_line(self.go(folder, *again, status=2), "-output_dir", "performance.json", "is not the program's")
        assert (folder / "performance.json").read_text() == "{}"

    # --- one run at a time ------------------------------------------------------------------------------------

    def check_lock(self):
        """The second run in a folder is refused and names the first, which goes on as if alone."""
        slow = ("-plate_velocity", "1e-4,-1e-4")  # the plate of the deck is through the soil within seconds
        for prefix in ((), RANKS):
            folder = fresh(self.base / "locked")
            first = self.start(folder, *self.endless, *slow, prefix=prefix)
            text = (folder / "mpm.lock").read_text()
            process = next(line.split()[1] for line in text.splitlines() if line.startswith("process "))
            assert prefix or int(process) == first.pid, (text, first.pid)
            for second in ((), ("-restart", "latest"), ("-restart", checkpoints(self.whole)[0])):
                for ranks in ((), RANKS):
                    done = self.go(folder, *second, status=2, prefix=ranks)
                    self.expect_line(done, "-output_dir", "takes a folder that no other run has", f"process {process} on ",
                                     os.uname().nodename, time.strftime("since %Y-"))
            self.go(folder, "-dry_run", "-time_max_steps", 3)
            assert first.poll() is None, "the first was over before the others were refused"
            os.kill(int(process), signal.SIGTERM)
            printed, errors = first.communicate(timeout=PATIENCE)
            assert first.returncode == 75, (first.returncode, errors)
            assert not faults_of_folder(folder) and not (folder / "mpm.lock").exists()
            whole = self.base / f"whole_of_{len(prefix)}"
            self.go(whole, *slow, prefix=prefix)
            common = min(len(rows(whole)), len(rows(folder))) - 1  # the last row may be one of the end
            assert common > 3 and rows(whole)[:common] == rows(folder)[:common]

    def check_stale_lock(self):
        """The lock of a run that was killed, of another boot or of another machine is taken over, and the log says so."""
        folder = fresh(self.base / "stale")
        first = self.start(folder, "-time_max_steps", 1200)
        while not checkpoints(folder):
            time.sleep(0.001)
        first.send_signal(signal.SIGKILL)
        first.communicate()
        lock = folder / "mpm.lock"
        text = lock.read_text()
        for left in (text, text.replace("boot ", "boot 0"), text.replace("host ", "host other-"), text[:60], text[:20], "",
                     "\0" * 100, text.replace(f"process {first.pid}", "process 1")):
            lock.write_text(left)
            done = self.go(folder, "-restart", "latest", "-time_max_steps", 1200)
            assert not lock.exists()
            assert len(left) < 150 or "which is gone" in done.stdout, done.stdout
        lock.write_text("mine")
        self.expect_line(self.go(folder, status=2), "mpm.lock", "no lock of this program")
        assert lock.read_text() == "mine"

    def check_locks_in_turn(self):
        """If several runs start at once in one folder, one of them runs; all others are refused."""
        for _ in range(2 if self.short else 8):
            folder = fresh(self.base / "race")
            runs = [subprocess.Popen(command(self.binary, DECK, folder, *OPTIONS, "-time_max_steps", 600), env=ENVIRONMENT,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(4)]
            for process in runs:
                process.communicate(timeout=PATIENCE)
            ended = [process.returncode for process in runs]
            assert sorted(ended) == [0, 2, 2, 2], ended
            assert len(rows(folder)) > 10 and not faults_of_folder(folder) and not (folder / "mpm.lock").exists()

    # --- what is no regular file --------------------------------------------------------------------------------

    def check_pipes(self):
        """A pipe, device or folder in lieu of a checkpoint, of particles or of the history: one line at once."""
        pipe = self.base / "pipe"
        os.mkfifo(pipe)
        for file, word in ((pipe, "this is a pipe"), ("/dev/zero", "this is a device"), (self.base, "this is a folder")):
            folder = fresh(self.base / "piped")
            self.expect_line(self.go(folder, "-restart", file, status=2), "-restart", file, word)
            self.expect_line(self.go(folder, "-soil_file", file, deck=self.listed, status=2), "-soil_file", file, word)
            assert not folder.exists()
        self.expect_line(self.go(folder, "-restart", pipe, status=2, prefix=RANKS), "-restart", pipe)
        for name in ("history.csv", "mpm.log", "checkpoint_9999.h5", "frames/frame_00001.h5", "options.json", "performance.json"):
            folder = self.copy_of_whole("piped")
            (folder / name).unlink(missing_ok=True)
            os.mkfifo(folder / name)
            before = everything(folder)
            for again in ((), ("-restart", "latest")):
                self.expect_line(self.go(folder, *again, status=2), "-output_dir", name)
            assert everything(folder) == before
        elsewhere = self.copy_of_whole("rows")
        (elsewhere / "history.csv").unlink()
        os.mkfifo(elsewhere / "history.csv")
        self.go(fresh(self.base / "piped"), "-restart", checkpoints(elsewhere)[0])

    # --- what is later goes last ----------------------------------------------------------------------------------

    def check_later_state(self):
        """Once a newer checkpoint is there, the files that a run is to make anew go, with the checkpoint that it came from."""
        folder = self.copy_of_whole("renamed")
        renamed, *_ = checkpoints(folder)
        latest = folder / "checkpoint_99999.h5"
        for path in checkpoints(folder)[1:]:
            path.unlink()
        renamed.rename(latest)
        kept = latest.read_bytes()
        # a run without checkpoints: nothing may be lost
        self.go(folder, "-restart", "latest", "-time_max_steps", 118, deck=self.no_checkpoints)
        assert latest.read_bytes() == kept
        self.go(folder, "-restart", "latest")
        assert checkpoints(folder) == [folder / "checkpoint_120.h5"]
        different = differences(self.whole, folder)
        assert not different, different

    def check_back_and_killed(self):
        """A run that goes back and is killed before its first checkpoint leaves one to go on from, which `latest` takes."""
        folder = self.copy_of_whole("back")
        early, late = checkpoints(folder)
        process = subprocess.Popen(command(self.binary, self.no_checkpoints, folder, *OPTIONS, "-restart", early, *self.endless),
                                   env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        bytes_before = (folder / "history.csv").stat().st_size
        while (folder / "history.csv").stat().st_size == bytes_before and process.poll() is None:
            time.sleep(0.001)
        process.kill()
        process.communicate()
        assert checkpoints(folder) == [early, late]
        done = self.go(folder, "-restart", "latest")
        assert f"{late} is passed over" in done.stdout and f"goes on from {early}" in done.stdout, done.stdout
        assert not differences(self.whole, folder)

    # --- memory -------------------------------------------------------------------------------------------------

    def check_memory(self):
        """A run that cannot fit into memory is refused before it allocates."""
        big = ("-mesh_upper", "2000,1000", "-plate_upper", "1999,900")
        meminfo = dict(line.split(":") for line in pathlib.Path("/proc/meminfo").read_text().splitlines())
        small = int(meminfo["MemAvailable"].split()[0]) < 40e6  # kB
        for options, word in ((("-plate_particles_per_cell", 16, *big), "of rigids"),
                              (("-mesh_upper", "3e4,3e4", "-mesh_spacing", 0.1), "patches"))[:2 if small else 1]:
            for how in ((), ("-dry_run",)):
                folder = fresh(self.base / "memory")
                self.expect_line(self.go(folder, *options, *how, status=2), "-mesh_spacing", word)
                assert not folder.exists()

    def check_little_memory(self):
        """A limit on the process's memory: refused for it, run, or ended with a line, whatever the limit.

        The limit is on addresses, of which the heap of each thread reserves more than it uses, so that a limit just above
        what the run needs may be met in its middle.
        """
        options = ("-mesh_spacing", 0.004, "-time_step", 1e-5, "-time_max_steps", 3, "-p2g", "sequential")
        found = []
        for megabytes in range(250, 1500, 250 if self.short else 50):
            def limit(size=megabytes << 20):
                resource.setrlimit(resource.RLIMIT_AS, (size, size))
            folder = fresh(self.base / "allocation")
            done = self.go(folder, *options, status=None, limit=limit)
            printed = [line for line in done.stderr.splitlines() if line.startswith("mpm: ")]
            if not printed and done.returncode != 0 and not folder.exists():
                continue  # not even MPI came up
            assert done.returncode == 0 or (done.returncode in (2, 3) and len(printed) == 1), (megabytes, done.returncode, done.stderr)
            found.append(done.returncode)
        assert 0 in found and 2 in found, found

    def check_failed_allocation(self):
        """Memory that the system does not give: one line, 2 before the first step and 3 later; never an abort."""
        found, count = {}, self.base / "count"
        for prefix in ((), RANKS):
            setting = {"LD_PRELOAD": self.inject, "INJECT_CALL": "malloc", "INJECT_BYTES": "60000"}  # smaller ones HDF5 does not survive
            count.write_bytes(b"")
            options = ("-time_max_steps", 30, "-mesh_spacing", 0.02, "-time_step", 5e-5, "-output_interval", 2e-4,
                       "-checkpoint_interval", 4e-4)
            self.go(fresh(self.base / "allocation"), *options, environment={**setting, "INJECT_COUNT": str(count)}, prefix=prefix)
            calls = count.stat().st_size // (2 if prefix else 1)
            for after in sorted(self.chance.sample(range(calls), (2 if prefix else 4) if self.short else (30 if prefix else 150))):
                folder = fresh(self.base / "allocation")
                done = self.go(folder, *options, status=None, environment={**setting, "INJECT_AFTER": str(after)}, prefix=prefix)
                printed = [line for line in done.stderr.splitlines() if line.startswith("mpm: ")]
                if not printed and not done.stdout:
                    continue  # libraries' own, before the program began
                assert done.returncode in (0, 1, 2, 3), (after, done.returncode, done.stdout[-500:], done.stderr)
                assert done.returncode == 0 or printed, (after, done.returncode, done.stderr)
                assert not folder.exists() or not faults_of_folder(folder), (after, faults_of_folder(folder))
                found[done.returncode] = found.get(done.returncode, 0) + 1
        return ", ".join(f"{found[status]} times {status}" for status in sorted(found))

    # --- paths and limits -----------------------------------------------------------------------------------------

    def check_strange_paths(self):
        """Line ends and tabulators in a path are refused in one line; bytes that are no UTF-8 do no harm."""
        for name in ("a\tb", "a\nb", "a\rb", "a\x1b[31mb"):
            self.expect_line(self.go(self.base / name, status=2), "-output_dir", "takes a text without line ends")
            assert not (self.base / name).exists()
            deck = self.base / (name + ".opts")
            shutil.copy(DECK, deck)
            done = subprocess.run([self.binary, "-options_file", str(deck), *map(str, OPTIONS)], env=ENVIRONMENT, cwd=self.base,
                                  capture_output=True, text=True, timeout=PATIENCE)
            assert done.returncode == 2, done
            self.expect_line(done, "-output_dir: default", "takes a folder without line ends")
        folder = os.fsdecode(os.fsencode(str(self.base)) + b"/sch\xf6n \"und\" \\gut")
        fresh(folder)
        self.go(folder, "-time_max_steps", 60)
        options = json.loads((pathlib.Path(folder) / "options.json").read_bytes().decode())
        assert "sch\ufffdn \"und\" \\gut" in options["options"]["output_dir"], options["options"]["output_dir"]
        self.go(folder, "-restart", "latest")
        assert not differences(self.whole, folder)

    def check_file_size_limit(self):
        """A limit on the size of files ends as a full disk does. (Several ranks: Open MPI does not come up.)"""
        for kilobytes in (1, 8, 30, 50):
            def limit(size=kilobytes << 10):
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
            folder = fresh(self.base / "limited")
            done = self.go(folder, status=1, limit=limit)
            self.expect_line(done, "File too large", folder)
            assert not folder.exists() or not faults_of_folder(folder), faults_of_folder(folder)

    def check_full_terminal(self):
        """Help that cannot be written is an error."""
        with open("/dev/full", "w") as full:
            done = subprocess.run([self.binary, "-help"], env=ENVIRONMENT, stdout=full, stderr=subprocess.PIPE, text=True,
                                  timeout=PATIENCE)
        assert done.returncode == 1, done
        self.expect_line(done, "Cannot write to the terminal")

    # --- signals --------------------------------------------------------------------------------------------------

    def check_signal_of_dry_run(self):
        """A dry run has nothing to save, and ends at once."""
        for sent in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            process = subprocess.Popen(command(self.binary, DECK, self.base / "dry", *OPTIONS, *self.endless, "-dry_run",
                                               "-mesh_spacing", 0.004, "-time_step", 1e-5), env=ENVIRONMENT,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while process.poll() is None and not process.stdout.readline().startswith("body soil"):
                pass
            process.send_signal(sent)
            process.communicate(timeout=PATIENCE)
            assert process.returncode == -sent, process.returncode

    def check_many_signals(self):
        """Signals that come while the checkpoint is written, as from a user who is in a hurry, do not spoil it."""
        ended = []
        for _ in range(2 if self.short else 8):
            folder = fresh(self.base / "hurry")
            process = self.start(folder, *self.endless, "-mesh_spacing", 0.01, "-time_step", 2e-5, "-checkpoint_interval", 10)
            process.send_signal(signal.SIGTERM)
            while process.poll() is None and not any(folder.glob("checkpoint_*.tmp")):
                time.sleep(0.001)
            while process.poll() is None:
                process.send_signal(signal.SIGTERM)
                time.sleep(0.02)
            process.communicate()
            ended.append(process.returncode)
            assert not faults_of_folder(folder)
        assert set(ended) == {75}, ended

    # --- altered data ---------------------------------------------------------------------------------------------

    def check_altered_checkpoints(self):
        """Every item of a checkpoint changed in many ways, under a sound seal: refused with 2 and a line, or gone on from."""
        folder, first = self.copy_of_whole("altered"), checkpoints(self.whole)[0]
        ways, ended, wrong = alterations(first), {}, []
        for name, change in self.chance.sample(ways, 40) if self.short else ways:
            file = self.base / first.name
            shutil.copy(first, file)
            change_sealed(file, change)
            assert is_whole(file)
            done = self.go(folder, "-restart", file, status=None)
            lines = done.stderr.splitlines()
            sound = {0: not lines, 2: len(lines) == 1 and "takes" in lines[0] and not differences(self.whole, folder),
                     3: len(lines) == 1 and "step" in lines[0]}  # numbers that may be, but not for long
            if not sound.get(done.returncode):
                wrong.append((name, done.returncode, done.stderr[:300]))
            ended[done.returncode] = ended.get(done.returncode, 0) + 1
            if done.returncode != 2:
                folder = self.copy_of_whole("altered")
        assert not wrong, "\n".join(map(str, wrong))
        return ", ".join(f"{ended[status]} times {status}" for status in sorted(ended))

    def check_altered_particles(self):
        """Particles with absurd sizes or of wrong kinds: one line at once."""
        frame, file = frames(self.whole)[0], self.base / "particles.h5"
        count = 0
        for name, change in alterations_of_particles():
            shutil.copy(frame, file)
            with h5py.File(file, "r+") as opened:
                change(opened["soil"])
            began = time.time()
            done = self.go(fresh(self.base / "absurd"), "-soil_file", file, deck=self.listed, status=2)
            self.expect_line(done, "-soil_file", "takes")
            assert time.time() - began < 20, name
            count += 1
        return f"{count} files"


def replace(path, value, **how):
    def change(file):
        del file[path]
        file.create_dataset(path, data=value, **how)
    return change


def alterations(path):
    """(name, change) for every attribute and dataset of a checkpoint."""
    ways = []
    with h5py.File(path) as file:
        attributes = {name: file.attrs[name] for name in file.attrs}
        datasets = {}
        file.visititems(lambda name, item: datasets.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)

    def attribute(name, value):
        def change(file):
            del file.attrs[name]
            if value is not None:
                file.attrs[name] = value
        ways.append((f"@{name} = {value!r:.40}", change))
    for name, value in attributes.items():
        attribute(name, None)
        attribute(name, np.zeros(3))
        if isinstance(value, (str, bytes, np.bytes_)):
            for text in ("", "x" * 3000, 7):
                attribute(name, text)
        else:
            for number in (-1, 2**31 - 1, -2**63, 2**63 - 1, 0):
                if np.issubdtype(np.asarray(value).dtype, np.integer):
                    attribute(name, np.int64(number))
            for number in (np.nan, np.inf, -1e300, 1e300, -1.0, 0.0):
                if not np.issubdtype(np.asarray(value).dtype, np.integer):
                    attribute(name, number)
            attribute(name, "text")
    for name, value in datasets.items():
        def gone(file, name=name):
            del file[name]
        changes = [("gone", gone), ("empty", replace(name, value[:0])), ("twice", replace(name, np.concatenate([value, value]))),
                   ("shorter", replace(name, value[:-1])), ("deeper", replace(name, value[None])),
                   ("text", replace(name, np.full(value.shape, b"abc"))),
                   ("huge", replace_by_size(name, (2**40,) + value.shape[1:], value.dtype))]
        if value.size and name != "options":
            odd = [np.nan, np.inf, 1e300, -1e300] if value.dtype.kind == "f" else [
                np.iinfo(value.dtype).min, np.iinfo(value.dtype).max, 2**15]
            for k, number in enumerate(odd):
                other = value.copy()
                other.flat[k % other.size] = number
                changes.append((f"has {number}", replace(name, other)))
        ways += [(f"{name} {what}", change) for what, change in changes]
    return ways


def replace_by_size(path, shape, dtype):
    """A dataset of so many rows, none of which is there."""
    def change(file):
        del file[path]
        file.create_dataset(path, shape=shape, dtype=dtype, chunks=(1024,) + shape[1:])
    return change


def alterations_of_particles():
    for name, width in (("position", (3,)), ("volume", ()), ("velocity", (3,)), ("stress", (6,)), ("plastic_strain", ())):
        for many in (10**6, 2**31, 2**40, 2**61):
            yield f"{name} of {many}", replace_by_size(name, (many, *width), "f8")
        yield f"{name} of none", replace(name, np.zeros((0, *width)))
        yield f"{name} of a wrong width", replace(name, np.ones((640, 2)))
        yield f"{name} of text", replace(name, np.full((640, *width), b"abc"))
        yield f"{name} of a scalar", replace(name, 1.0)
        yield f"{name} not finite", replace(name, np.full((640, *width), np.nan))


def main():
    words = [word for word in sys.argv[1:] if word != "--short"]
    binary, inject, *names = words
    checks = Checks(pathlib.Path(binary).absolute(), inject, short=len(words) < len(sys.argv) - 1)
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
