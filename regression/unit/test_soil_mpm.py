#!/usr/bin/env python3
"""soil_mpm: decks by the schema of the program, runs, results, sweeps.

usage: test_soil_mpm.py PATH_TO_mpm
"""

import contextlib
import copy
import io
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import h5py
import numpy as np

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
os.environ["MPM_PROGRAM"] = str(PROGRAM)

from soil_mpm import (Answer, Deck, NoProgram, NoSuchResult, Run, RunFailed, UnknownOption, WrongDeck, WrongValue, __main__, certify, frames, launch,
                      shipped, sweep)
from soil_mpm.certificate import bar_of, judge, meshes
from soil_mpm.deck_text import DeckText
from soil_mpm.schema import Schema

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = dict(dim=2, mesh_lower=(0, 0), mesh_upper=(4, 4), mesh_spacing=0.5, time_end=0.1, gravity=(0, -10), backend="serial",
             materials="rock", rock_model="linear_elastic", rock_density=2000, rock_young=1e6, rock_poisson=0.25,
             bodies="block", block_material="rock", block_shape="box", block_lower=(0, 0), block_upper=(4, 2), output_interval=0.05)


class Options(unittest.TestCase):
    def setUp(self):
        self.deck = Deck(BLOCK)

    def test_values_have_their_kinds(self):
        self.assertEqual(self.deck.mesh_spacing, 0.5)
        self.assertEqual(self.deck.gravity, (0.0, -10.0))
        self.assertEqual(self.deck["block_shape"], "box")
        self.assertIs(self.deck.output_energy, False)  # a default
        self.assertEqual(self.deck.output_compression, Schema.of_program().find("output_compression", {})[0].value(
            Schema.of_program().find("output_compression", {})[0].default))
        self.assertIsNone(self.deck.time_step)
        self.deck.output_energy = True
        self.assertEqual(self.deck.given()["output_energy"], "on")

    def test_unknown_names_have_the_nearest(self):
        for name, nearest in (("rock_youngs", "rock_young"), ("mesh_spacin", "mesh_spacing"), ("blok_lower", "block_lower")):
            with self.assertRaisesRegex(UnknownOption, f"nearest is -{nearest}"):
                self.deck[name] = 1
        with self.assertRaisesRegex(UnknownOption, "sand is in none of -materials"):
            self.deck.sand_young = 1
        with self.assertRaises(AttributeError):
            self.deck.no_such_thing

    def test_values_out_of_range_are_refused_in_the_words_of_the_program(self):
        for name, value, takes in (("mesh_spacing", 0, "greater than 0"), ("rock_poisson", 0.5, "from -0.99 to 0.4999"),
                                   ("dim", 4, "from 2 to 3"), ("mesh_lower", (0, 0, 0), "2 numbers"), ("mesh_xmin", "rollr", "nearest is roller"),
                                   ("time_end", "soon", "a time in s"), ("output_dir", "a # b", "without #")):
            with self.assertRaisesRegex(WrongValue, takes):
                self.deck[name] = value
        self.assertEqual(self.deck.mesh_spacing, 0.5)

    def test_former_names_are_those_of_today(self):
        self.deck.flip_share = 0.5
        self.assertEqual(self.deck.flip_fraction, 0.5)
        self.assertIn("-flip_fraction 0.5", str(self.deck))

    def test_dir_has_the_options_that_have_a_place(self):
        names = dir(self.deck)
        self.assertIn("rock_young", names)
        self.assertIn("block_fillet", names)
        self.assertNotIn("rock_su", names)
        self.assertNotIn("block_radius", names)

    def test_faults_without_the_program(self):
        self.assertEqual(self.deck.faults(), [])
        del self.deck.rock_young
        self.assertRegex(self.deck.faults()[0], "-rock_young: not given, takes a number in Pa")
        self.deck.update(rock_model="von_mises", rock_rigidity=500, rock_su=1000, block_material="clay")
        self.assertRegex(self.deck.faults()[0], '-block_material: given "clay", takes names of -materials: rock')
        self.deck.update(block_material="rock", block_radius=1)
        self.assertRegex(self.deck.faults()[0], "-block_radius: .* only where -block_shape is disc, ball, cylinder or cone")

    def test_the_program_finds_what_the_table_cannot(self):
        self.deck.block_upper = (4, -1)
        self.assertEqual(self.deck.faults(), [])
        self.assertRegex(self.deck.check()[0], "block_upper")
        with self.assertRaisesRegex(WrongDeck, "block_upper"):
            self.deck.dry_run()

    def test_copies_are_apart(self):
        for other in (copy.copy(self.deck), copy.deepcopy(self.deck), pickle.loads(pickle.dumps(self.deck)), self.deck.copy()):
            other.mesh_spacing = 0.25
            self.assertEqual((self.deck.mesh_spacing, other.mesh_spacing, other.rock_young), (0.5, 0.25, 1e6))

    def test_options_go_with_their_name(self):
        self.deck.update(materials="clay", clay_model="linear_elastic", clay_density=1, clay_young=1e6, clay_poisson=0, block_material="clay")
        self.assertNotIn("rock", str(self.deck))
        self.assertEqual(self.deck.faults(), [])

    def test_stages_and_parts(self):
        deck = self.deck.copy(stages="rest,push", push_gravity=(0, -5), rest_end="equilibrium")
        self.assertEqual(deck.push_gravity, (0.0, -5.0))
        with self.assertRaises(UnknownOption):
            deck.push_dim = 3
        deck.update(rigid_bodies="anchor", anchor_parts="shank,fluke", fluke_shape="box", fluke_lower=(1, 3), fluke_upper=(2, 3.5))
        self.assertNotIn("-anchor_shape: not given", "\n".join(deck.faults()))
        self.assertIn("-shank_shape: not given", "\n".join(deck.faults()))

    def test_every_deck_of_the_tree_is_known(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(ROOT)  # from which decks name files
        for path in sorted(pathlib.Path("inputs").glob("*.opts")):
            deck = Deck.read(path)
            self.assertEqual(str(deck), path.read_text(), path)
            self.assertEqual(deck.faults(), [], path)

    def test_without_a_program(self):
        with self.assertRaisesRegex(NoProgram, "MPM_PROGRAM"):
            Deck(program="/no/such/mpm")


class Schemas(unittest.TestCase):
    def said(self, *words):
        return subprocess.run([PROGRAM, *words], capture_output=True, text=True)

    def test_the_schema_has_what_help_prints(self):
        schema, listed = Schema.of_program(), self.said("-help").stdout
        self.assertEqual([option.name for option in schema.options], re.findall(r"^  -(\w+)$", listed, re.MULTILINE))
        for option in schema.options:
            self.assertIn(f"takes {option.takes}; ", listed)
            self.assertEqual(option.owned, bool(option.owners), option.name)
            self.assertIn(option.kind, ("number", "integer", "numbers", "text", "flag", "word", "list"))
            if option.default is not None and option.kind == "word" and option.default in option.choices:
                self.assertEqual(option.text(option.default, 2), option.default)

    def test_help_of_one_option(self):
        for name in ("rock_young", "-NAME_young", "--mesh_spacing", "p2g_margin"):
            done = self.said("-help", name)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
        self.assertIn("only where -NAME_model is mohr_coulomb", self.said("-help", "sand_friction_deg").stdout)
        self.assertNotIn("NAME_young_gradient", self.said("-help", "rock_young").stdout)
        self.assertIn("-rebuild_margin", self.said("-help", "p2g_margin").stdout)
        wrong = self.said("-help", "mesh_spacin")
        self.assertEqual((wrong.returncode, wrong.stdout), (2, ""))
        self.assertEqual(wrong.stderr, 'mpm: -help: given "mesh_spacin", takes the name of an option; the nearest is -mesh_spacing\n')
        self.assertGreater(len(self.said("-help", "-options_file", "none.opts").stdout), 10000)


class Texts(unittest.TestCase):
    TEXT = "# a deck\n-dim 2  # plane\n\n-materials rock\n-output_dir \"a b\"\n"

    def test_comments_stay(self):
        deck = Deck()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.opts"
            path.write_text(self.TEXT)
            deck = Deck.read(path)
            self.assertEqual(str(deck), self.TEXT)
            deck.dim, deck.output_dir = 3, "c d"
            deck.mesh_spacing = 0.1
            self.assertEqual(str(deck), self.TEXT.replace("dim 2", "dim 3").replace("a b", "c d") + "-mesh_spacing 0.1\n")
            del deck.mesh_spacing
            del deck.materials
            deck.write(path)
            self.assertEqual(path.read_text(), "# a deck\n-dim 3  # plane\n\n-output_dir \"c d\"\n")

    def test_included_decks(self):
        with tempfile.TemporaryDirectory() as folder:
            inner, outer = pathlib.Path(folder) / "inner.opts", pathlib.Path(folder) / "outer.opts"
            inner.write_text("-dim 3\n-mesh_spacing 1\n")
            outer.write_text(f"-options_file {inner}\n-mesh_spacing 0.5\n")
            deck = Deck.read(outer)
            self.assertEqual((deck.dim, deck.mesh_spacing), (3, 0.5))
            outer.write_text(f"-mesh_spacing 0.5\n-options_file {inner}\n")
            deck = Deck.read(outer)
            self.assertEqual(deck.mesh_spacing, 1.0)  # the last one counts
            deck.mesh_spacing = 2
            self.assertEqual((deck.mesh_spacing, str(deck).splitlines()[-1]), (2.0, "-mesh_spacing 2"))
            with self.assertRaisesRegex(WrongDeck, "included"):
                del deck["dim"]

    def test_what_is_no_deck(self):
        for text in ("-a 1 2\n", "word\n", "-a 1 -b 2\n"):
            with self.assertRaisesRegex(WrongDeck, "deck:1"):
                DeckText.of(text)
        with self.assertRaises(WrongDeck):
            Deck.read("/no/such.opts")


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(kept.cleanup)
        cls.folder = pathlib.Path(kept.name)
        cls.fractions = []
        cls.deck = Deck(BLOCK)
        cls.run_ = cls.deck.run(cls.folder / "block", progress=lambda fraction, time: cls.fractions.append(fraction))

    def test_a_run_and_its_progress(self):
        self.assertEqual((self.run_.outcome, self.run_.dim), ("finished", 2))
        self.assertEqual(self.fractions[-1], 1.0)
        self.assertEqual(self.fractions, sorted(self.fractions))

    def test_history(self):
        table, time = self.run_.table(), self.run_["time"]
        self.assertEqual(time[-1], 0.1)
        self.assertEqual(len(table), len(time))
        self.assertTrue(np.array_equal(table["block_mass"], self.run_["block_mass"]))
        with self.assertRaisesRegex(NoSuchResult, "nearest is block_mass"):
            self.run_["block_mas"]

    def test_frames_are_read_as_far_as_asked(self):
        with self.run_.frame_at(time=0.051) as frame:
            self.assertAlmostEqual(frame.time, 0.05, places=2)
            body = frame["block"]
            self.assertIsInstance(body["stress"], h5py.Dataset)
            self.assertEqual(body["stress"][:3, 1].shape, (3,))
            self.assertEqual(body.count, len(body.position))
            np.testing.assert_allclose(body.field("pressure"), -body.stress[:, :3].mean(axis=1))
            self.assertEqual((body.unit("mises"), body.unit("velocity_y"), body.unit("stress")), ("Pa", "m/s", "Pa"))
            with self.assertRaisesRegex(NoSuchResult, "no field heat"):
                body.field("heat")
            with self.assertRaisesRegex(NoSuchResult, "there are block"):
                frame["blok"]

    def test_fields_at_places(self):
        with self.run_.frame_at() as frame:
            line = frame.on_line((2, 0.2), (2, 1.8), ["position", "stress"], points=5)
            self.assertEqual((line["way"][-1], line["stress"].shape), (1.6, (5, 6)))
            np.testing.assert_allclose(line["position"][:, 1], np.linspace(0.2, 1.8, 5), atol=1e-9)  # linear functions are exact
            grid = frame.on_grid("velocity_y")
            self.assertEqual(grid["velocity_y"].shape, (8, 4))
            self.assertEqual(grid["x"][0], 0.25)
            self.assertTrue(np.isnan(frame.at((2, 3.5), "velocity_y")["velocity_y"][0]))
            with self.assertRaises(NoSuchResult):
                frame.on_section("y", 0, "velocity_y")

    def test_parts_of_a_frame_are_the_same_as_parts_of_the_whole(self):
        """However many particles are read at a time."""
        with self.run_.frame_at() as frame:
            body, box = frame["block"], frame.corners()
            whole = {name: body.field(name) for name in (*body.fields(), "speed")}
            values = frame.at([(1.1, 0.7), (2, 1.9)], ["stress", "mises"])
            for count in (1, 7, 64, 1 << 20):
                with unittest.mock.patch.object(frames, "AT_ONCE", count):
                    for rows in (slice(3, 90, 4), [0, 2, 63, 64, 65, body.count - 1], []):
                        for name, field in whole.items():
                            np.testing.assert_array_equal(body.field(name, rows), field[rows if isinstance(rows, slice) else np.array(rows, int)])
                    np.testing.assert_array_equal(frame.corners(), box)
                    for name, field in frame.at([(1.1, 0.7), (2, 1.9)], ["stress", "mises"]).items():
                        np.testing.assert_array_equal(field, values[name])
            low = body["position"][:, 1] < 0.5
            np.testing.assert_array_equal(body.field("mises", low), whole["mises"][low])
            for wrong in ([2, 1], [1, 1], [-1, 0], [0, body.count], low[1:], [0.5], 3, slice(9, 3, -1)):
                with self.assertRaisesRegex(NoSuchResult, "rows takes"):
                    body.field("mises", wrong)
            self.assertTrue(np.isnan(frame.at((-100, -100), "mises")["mises"]).all())

    def test_what_fails_has_the_words_of_the_program(self):
        deck = self.deck.copy(block_upper=(4, -1))
        with self.assertRaisesRegex(RunFailed, "block_upper") as caught:
            deck.run(self.folder / "wrong", progress=False)
        self.assertEqual(caught.exception.status, launch.BAD_INPUT)
        self.assertFalse((self.folder / "wrong").exists())

    def test_sweeps(self):
        out = self.folder / "sweep"
        swept = sweep(self.deck, {"rock_young": [1e6, 2e6], "rock_density": [1000]}, out, progress=False, jobs=2)
        table = swept.table("block_mass", "time:max", ("top", lambda run: run["block_ymax"][0]))
        np.testing.assert_allclose(table["block_mass"], 8000)
        np.testing.assert_allclose(table["rock_young"], [1e6, 2e6])
        np.testing.assert_allclose(table["time:max"], 0.1)
        written = swept.write_table(out / "results.csv", "block_mass", ("double", lambda run: 2 * run["block_mass"][-1])).read_text().split()
        self.assertEqual((written[0], len(written)), ("run,rock_young,rock_density,block_mass,double", 3))
        self.assertEqual(float(written[2].split(",")[-1]), 2 * table["block_mass"][1])
        stamp = (out / "run_0000" / "history.csv").stat().st_mtime_ns
        again = sweep(self.deck, {"rock_young": [1e6, 2e6], "rock_density": [1000]}, out, progress=False)
        self.assertEqual((again.finished(), stamp), ([0, 1], (out / "run_0000" / "history.csv").stat().st_mtime_ns))
        with self.assertRaises(WrongValue):  # before any run
            sweep(self.deck, [{"rock_young": 1e6}, {"rock_young": -1}], self.folder / "none", progress=False)
        self.assertFalse((self.folder / "none").exists())

    def test_commands(self):
        path = self.deck.write(self.folder / "command.opts")
        for words, status, said in ((["check", str(path)], 0, "particles"), (["check", str(path), "-block_upper", "4,-1"], 2, "block_upper"),
                                    (["run", str(path), "--out", str(self.folder / "by_command"), "-time_end", "0.05"], 0, "by_command"),
                                    (["run", str(path), "-no_such", "1"], 2, "no such option")):
            out = io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
                self.assertEqual(__main__.main(words), status, out.getvalue())
            self.assertRegex(out.getvalue(), re.escape(said))
        self.assertEqual(Run(self.folder / "by_command")["time"][-1], 0.05)

    def test_slurm(self):
        script = self.folder / "sbatch"
        script.write_text("#!/bin/sh\nshift\n\"$MPM\" -options_file \"$@\" -output_dir \"$MPM_OUTPUT\" -progress off >/dev/null "
                          "&& echo Submitted batch job 17\n")
        script.chmod(0o755)
        path = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", path)
        os.environ["PATH"] = f"{self.folder}:{path}"
        job = self.deck.submit("job.sbatch", self.folder / "queued")
        self.assertEqual((job.number, job.state()), ("17", "FINISHED"))
        self.assertEqual(job.wait()["time"][-1], 0.1)


class Environment(unittest.TestCase):
    def test_threads_give_way_on_a_busy_machine(self):
        with unittest.mock.patch.dict(os.environ):
            os.environ.pop("OMP_WAIT_POLICY", None)
            for load, policy in ((0.1, None), (3.0, "passive")):
                with unittest.mock.patch.object(os, "getloadavg", lambda load=load: (load, load, load)):
                    self.assertEqual(launch.environment().get("OMP_WAIT_POLICY"), policy)
                    self.assertEqual(launch.environment(more={"OMP_WAIT_POLICY": "active"})["OMP_WAIT_POLICY"], "active")

    def test_a_program_for_another_processor(self):
        with unittest.mock.patch.object(launch, "follow", lambda *_: (-signal.SIGILL, "")), tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(RunFailed, "was built for another processor"):
                Deck(BLOCK).run(folder, progress=False)


class Shipped(unittest.TestCase):
    """Decks that come with the program, by name."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def test_every_deck_has_a_title(self):
        self.assertEqual(shipped.names(), sorted(path.stem for path in (ROOT / "inputs").glob("*.opts")))
        for name in shipped.names():
            self.assertRegex(shipped.title(name), r"^\w.{15,}[^.:;]$", name)

    def test_a_name_stands_for_its_deck(self):
        deck = Deck.read("footing_coarse")
        self.assertEqual(deck.given(), Deck.read(ROOT / "inputs" / "footing_coarse.opts").given())
        self.assertEqual(launch.output_folder(deck, None), pathlib.Path("out/footing_coarse"))
        for name in ("boulders", "rolling_boulder"):  # whose files lie beside them
            self.assertEqual(Deck.read(name).faults(), [], name)
        self.assertTrue(pathlib.Path(Deck.read("boulders").given()["rigid_bodies_file"]).is_file())
        with self.assertRaisesRegex(WrongDeck, "footing_corse: no deck .* the nearest is footing_coarse"):
            Deck.read("footing_corse")
        with self.assertRaisesRegex(WrongDeck, "no_such_deck: no deck of this name"):
            Deck.read("no_such_deck")
        with self.assertRaisesRegex(WrongDeck, "cannot be read"):
            Deck.read("no_such_deck.opts")

    def test_a_file_goes_before_a_name(self):
        Deck(BLOCK).write("footing_coarse")
        self.assertEqual(Deck.read("footing_coarse").given()["bodies"], "block")

    def test_paths_with_blanks(self):
        place = pathlib.Path("a b")
        (place / "inputs").mkdir(parents=True)
        for path in shipped.files_of("boulders"):
            (place / "inputs" / path.name).write_bytes(path.read_bytes())
        with unittest.mock.patch.object(shipped, "decks_folder", lambda: place.resolve() / "inputs"):
            self.assertTrue(pathlib.Path(Deck.read("boulders").given()["rigid_bodies_file"]).is_file())

    def test_copies(self):
        self.assertEqual(shipped.copy("terrain_slide_fine"), pathlib.Path("inputs/terrain_slide_fine.opts"))
        self.assertEqual(sorted(os.listdir("inputs")), ["terrain_slide.opts", "terrain_slide_fine.opts"])
        shipped.copy("terrain_slide")  # is there already
        pathlib.Path("inputs/terrain_slide.opts").write_text("-dim 3\n")
        with self.assertRaisesRegex(WrongDeck, "not written over"):
            shipped.copy("terrain_slide_fine")
        with self.assertRaisesRegex(WrongDeck, "no deck of this name"):
            shipped.copy("../README")

    def test_commands(self):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            self.assertEqual(__main__.main(["decks"]), 0)
            self.assertEqual(__main__.main(["decks", "boulders"]), 0)
            words = ["run", "footing_coarse", "--threads", "1", "-time_end", "0.02", "-mesh_spacing", "0.25", "-mesh_upper", "3,4.5"]
            self.assertEqual(__main__.main([*words, "--no-pictures"]), 0)
            self.assertNotIn(".png", out.getvalue())
            self.assertEqual(__main__.main(words), 0)
        self.assertIn("footing_coarse           Strip footing", out.getvalue())
        self.assertIn("inputs/boulders.opts", out.getvalue())
        self.assertIn("out/footing_coarse/field.png", out.getvalue())


class Certificates(unittest.TestCase):
    def test_answers(self):
        for text in ("a_x at end", "a_x at max", "a_x at b_y=-0.5", "a_x over time=0.1:0.2"):
            self.assertEqual(str(Answer.of(text)), text)
        for text in ("a_x", "a_x at b_y", "a_x over b_y=1", "a_x at b_y=1:2", "a_x at b=c"):
            with self.assertRaisesRegex(WrongValue, "--answer"):
                Answer.of(text)

    def test_orders_and_bars(self):
        for order in (1, 2):
            values = [1 + h ** order for h in (0.1, 0.2, 0.4)]
            found, extrapolated, bar = bar_of(values, 0.0)
            self.assertAlmostEqual(found, order)
            self.assertAlmostEqual(extrapolated, 1.0)
            self.assertGreater(bar, abs(values[0] - 1))
        order, extrapolated, bar = bar_of([1.0, 1.1, 0.9], 0.0)  # to and fro
        self.assertEqual((order, extrapolated), (None, None))
        self.assertGreaterEqual(bar, 0.2)
        order, extrapolated, bar = bar_of([1.0, 1.1, 1.15], 0.0)  # further and further apart
        self.assertAlmostEqual(order, -1.0)
        self.assertIsNone(extrapolated)
        self.assertGreater(bar, 0.7)
        self.assertEqual(bar_of([2.0, 2.0, 2.0], 0.1)[2], 0.2)  # the ripple alone

    def test_verdicts(self):
        sound = {"mass": 0.0, "momentum": "not told", "energy": 0.01}
        self.assertEqual(judge(1.0, [1.0, 1.1, 1.3], 0.04, 1.0, sound, 0.05)[0], "converged")
        self.assertEqual(judge(1.0, [1.0, 1.1, 1.3], 0.1, 1.0, sound, 0.05)[0], "not converged")
        self.assertEqual(judge(None, [1.0, 1.1, 0.9], 0.3, 1.0, sound, 0.05)[0], "cannot say")
        self.assertRegex(judge(-1.0, [1.0, 1.1, 1.15], 0.7, 1.0, sound, 0.05)[1], "more and more")
        self.assertEqual(judge(1.0, [1.0, 1.1, 1.3], 0.04, 1.0, {**sound, "mass": 0.1}, 0.05)[0], "cannot say")

    def test_meshes(self):
        deck = Deck(BLOCK)
        self.assertEqual([each.mesh_spacing for each in meshes(deck)], [0.5, 1.0, 2.0])
        grown = meshes(deck.copy(mesh_upper=(4, 4.5), mesh_ymax="free"))
        self.assertEqual(grown[0].mesh_upper, (4.0, 6.0))
        for changes, why in (({"mesh_upper": (4.5, 4)}, "no free side"), ({"block_shape": "particles", "block_file": "a.h5"}, "particles of a file"),
                             ({"restart": "latest"}, "checkpoint"),
                             ({"rock_model": "softening_clay", "rock_su": 1e3, "rock_remoulded_ratio": 0.2, "rock_xi95": 1}, "no limit")):
            with self.assertRaisesRegex(WrongDeck, why):
                meshes(deck.copy(**changes))

    def test_a_weight(self):
        deck = Deck(BLOCK).copy(damping=0.7, time_end=2, rock_young=1e7, mesh_spacing=0.25, output_frames=False, history_interval=0.02)
        with tempfile.TemporaryDirectory() as folder:
            found = certify(deck, "wall_ymin_force_y over time=1.5:2", folder)
            self.assertTrue(found.holds(-2000 * 8 * 10), str(found))
            self.assertEqual(found.verdict, "converged", str(found))
            self.assertIn("not told with damping", str(found))
            self.assertEqual(certify(deck, "block_mass at end", folder).value, 16000)  # by the same runs
            with self.assertRaisesRegex(NoSuchResult, "nearest is block_mass"):
                certify(deck, "block_mas at end", folder)
            late = certify(deck, "block_mass at time=9", folder)
            self.assertEqual((late.verdict, late.bar), ("cannot say", None))
            self.assertIn("does not come to 9", str(late))


if __name__ == "__main__":
    unittest.main()
