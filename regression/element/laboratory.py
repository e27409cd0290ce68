#!/usr/bin/env python3
"""Laboratory tests by scripts/element against closed forms, and fits that find the parameters of made data again.

Usage: laboratory.py PATH_TO_mpm [--precisions double,single] [WORD ...]   (WORD: only checks whose name holds it)

Sources of the closed forms: Davis (1968) for simple shear of a Mohr-Coulomb soil; Roscoe & Burland (1968) for Cam-Clay;
Einav & Randolph (2005) for softening clay; Jop, Forterre & Pouliquen (2006) for mu(I). docs/soils.md states them.
"""
import argparse
import math
import os
import pathlib
import random
import subprocess
import sys

from mpm_regression.point import deck_of, read_table, run_point, scratch_folder, write_path

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "element"
SAND = dict(young=2e7, poisson=0.3, cohesion=5000, friction_deg=30, dilation_deg=10)
CLAY = {"critical_state_ratio": 1, "lambda": 0.2, "kappa": 0.04, "poisson": 0.25, "specific_volume": 2, "pressure_min": 1}
SOFT = dict(young=1.5e6, poisson=0.49, su=3000, remoulded_ratio=0.2, xi95=10, rate_factor=0.1, rate_reference=1e-3)
GRAINS = dict(young=1e6, poisson=0.3, mu_static=0.38, mu_dynamic=0.64, inertial_number=0.279, grain_diameter=5e-4,
              grain_density=2450)
PASTE = dict(bulk_modulus=1e7, shear_modulus=1e4, yield_stress=30, consistency=5)
LOOSER = {"single": 30}  # single precision: the tolerances times this, and never less than its round-off
ROUND_OFF = {"double": 0.0, "single": 5e-5}


def slope(degrees):
    """k or m of an angle: (1 + sin) / (1 - sin)."""
    return (1 + math.sin(math.radians(degrees))) / (1 - math.sin(math.radians(degrees)))


def engineering(logarithmic):
    return 1 - math.exp(-logarithmic)


class Laboratory:
    def __init__(self, binary, folder, precision):
        self.binary, self.folder, self.precision, self.faults = binary, pathlib.Path(folder), precision, []

    def run(self, name, deck, *words):
        """Runs scripts/element on a deck; what it printed."""
        folder = self.folder / f"{name}_{self.precision}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "deck.opts").write_text(deck)
        command = [sys.executable, str(SCRIPT), str(folder / "deck.opts"), "--out", str(folder), "--mpm", str(self.binary),
                   "--jobs", "2", "--option", f"-precision {self.precision}", *words]
        result = subprocess.run(command, capture_output=True, text=True, timeout=900)
        if result.returncode != 0:
            raise RuntimeError(f"{name}: status {result.returncode}\n{result.stdout}{result.stderr}")
        return folder, result.stdout

    def test(self, name, model, parameters, words, *options):
        """results.csv and element.csv of one test."""
        folder, _ = self.run(name, deck_of(model, **parameters), "--test", words + ",name=it", *options)
        if not list(folder.glob("*.png")):
            self.faults.append(f"{name}: no picture")
        return read_table(folder / "it" / "results.csv"), read_table(folder / "it" / "element.csv")

    def near(self, name, value, right, tolerance):
        tolerance = max(tolerance * (LOOSER.get(self.precision, 1) if tolerance < 1e-3 else 1), ROUND_OFF[self.precision])
        off = abs(value / right - 1)
        print(f"{name:58s} {self.precision:6s} {value:14.6g} {right:14.6g} {off:.1e}")
        if not off <= tolerance:
            self.faults.append(f"{name} in {self.precision}: {value:.9g} in lieu of {right:.9g}, off by {off:.2e} of {tolerance:g}")


def clays(lab):
    undrained = dict(young=5e5, poisson=0.49, su=1000)
    for model, triaxial in (("tresca", 2000), ("von_mises", math.sqrt(3) * 1000)):
        for kind, right in (("biaxial", 2000), ("triaxial", triaxial)):
            for drainage in ("drained", "undrained"):
                found, _ = lab.test(f"{model}_{kind}_{drainage}", model, undrained, f"{kind},cell=1e4,strain=0.05,"
                                    f"drainage={drainage}")
                lab.near(f"{model}: {drainage} {kind} compression", found["q"][-1], right, 1e-6)


def sand_triaxial(lab):
    k, m = slope(30), slope(10)
    # few parts: in single precision the strain rate of a part is known to the round-off of the stress, 0.03 Pa, over the
    # stress that the part's strain could change
    found, point = lab.test("compression", "mohr_coulomb", SAND, "triaxial,cell=100e3,strain=0.05", "--parts", "4")
    lab.near("Mohr-Coulomb: drained triaxial compression", found["q"][-1], (k - 1) * 1e5 + 1e4 * math.sqrt(k), 1e-6)
    lab.near("Mohr-Coulomb: the same in figures", found["q"][-1], 217320.5, 1e-6)
    volume = [sum(point[e][n] for e in ("exx", "eyy", "ezz")) for n in (-60, -1)]
    lab.near("Mohr-Coulomb: volume over axial strain", (volume[1] - volume[0]) / (point["eyy"][-1] - point["eyy"][-60]), 1 - m,
             1e-6)
    found, _ = lab.test("extension", "mohr_coulomb", SAND, "triaxial,cell=100e3,strain=0.05,direction=extension")
    lab.near("Mohr-Coulomb: triaxial extension, axial stress", found["vertical_stress"][-1], 27559.8, 2e-6)
    lab.near("Mohr-Coulomb: cell pressure in extension", found["lateral_stress"][-1], 1e5, 1e-6)


def sand_constant_mean(lab):
    """At a constant mean stress nothing elastic changes the volume: q = 3 G e up to failure, at the cone of the principal
    stresses whose mean is kept."""
    k, m, p = slope(30), slope(10), 1e5
    for direction, right in (("compression", (k - 1) * (3 * p - 1e4 * math.sqrt(k)) / (k + 2) + 1e4 * math.sqrt(k)),
                             ("extension", -((k - 1) * (3 * p - 2e4 * math.sqrt(k)) / (2 * k + 1) + 1e4 * math.sqrt(k)))):
        found, point = lab.test(f"mean_{direction}", "mohr_coulomb", SAND, f"triaxial,cell=100e3,constant=p,strain=0.05,"
                                f"direction={direction}", "--parts", "4")
        lab.near(f"Mohr-Coulomb: {direction} at constant p", found["q"][-1], right, 1e-6)
        lab.near(f"Mohr-Coulomb: largest p in {direction}", max(found["p"]), p, 1e-6)
        lab.near(f"Mohr-Coulomb: least p in {direction}", min(found["p"]), p, 1e-6)
        lab.near(f"Mohr-Coulomb: lateral stresses in {direction}", point["sxx"][-1], point["szz"][-1], 1e-6)
        lab.near(f"Mohr-Coulomb: 3 G in {direction}", found["q"][5] / -point["eyy"][5], 3 * 2e7 / 2.6, 1e-6)
        lab.near(f"Mohr-Coulomb: elastic volume in {direction}", 1 + found["volume_strain"][5], 1, 1e-9)
        volume = [sum(point[e][n] for e in ("exx", "eyy", "ezz")) for n in (-40, -1)]
        lab.near(f"Mohr-Coulomb: dilation in {direction}", (volume[1] - volume[0]) / (point["eyy"][-1] - point["eyy"][-40]),
                 1 - m if direction == "compression" else 1 - 1 / m, 1e-6)
    soil = dict(young=1e7, poisson=0.3, cohesion=8000, friction_deg=25, dilation_deg=5, match="compression")
    found, _ = lab.test("mean_cone", "drucker_prager", soil, "biaxial,cell=50e3,constant=p,strain=0.1")
    lab.near("Drucker-Prager: p of the biaxial test", max(abs(p - 5e4) for p in found["p"]) / 5e4 + 1, 1, 1e-6)


def sand_k0_start(lab):
    found, _ = lab.test("k0_start", "mohr_coulomb", SAND, "triaxial,cell=50e3,k0=0.5,strain=0.1")
    lab.near("Mohr-Coulomb: from K0, first deviator", found["q"][0], 5e4, 1e-9)
    k = slope(30)
    lab.near("Mohr-Coulomb: from K0, strength", found["q"][-1], (k - 1) * 5e4 + 1e4 * math.sqrt(k), 1e-6)


def sand_shear(lab):
    found, _ = lab.test("shear_stress", "mohr_coulomb", SAND, "shear,vertical=100e3,hold=stress,strain=0.4,rows=400")
    lab.near("Mohr-Coulomb: simple shear at constant stress (Davis)", found["shear_stress"][-1], 58591.9, 1e-4)
    lab.near("Mohr-Coulomb: 99 % of it at 3 %", found["shear_stress"][30], 0.99 * 58591.9, 3e-3)
    lab.near("Mohr-Coulomb: its vertical stress", found["vertical_stress"][-1], 1e5, 1e-6)
    found, _ = lab.test("shear_volume", "mohr_coulomb", dict(SAND, dilation_deg=0), "shear,vertical=100e3,hold=volume,strain=0.4")
    lab.near("Mohr-Coulomb: simple shear at constant volume", found["shear_stress"][-1], 54330.1, 1e-4)


def sand_oedometer(lab):
    soil = dict(young=2e7, poisson=0.2, cohesion=0, friction_deg=30)
    found, point = lab.test("oedometer", "mohr_coulomb", soil, "oedometer,vertical=1e3,stress=400e3")
    lab.near("Mohr-Coulomb: oedometer, K0 = Ka", found["lateral_stress"][-1] / found["vertical_stress"][-1], 1 / 3, 1e-6)
    lab.near("Mohr-Coulomb: oedometer, last stress", found["vertical_stress"][-1], 4e5, 1e-6)
    modulus = (point["syy"][-1] - point["syy"][-2]) / (point["eyy"][-1] - point["eyy"][-2])
    lab.near("Mohr-Coulomb: oedometer, modulus", modulus, 20e6, 1e-6)


def cone_biaxial(lab):
    soil = dict(young=1e7, poisson=0.3, cohesion=8000, friction_deg=25, dilation_deg=5, match="plane_strain")
    found, _ = lab.test("cone", "drucker_prager", soil, "biaxial,cell=50e3,strain=0.2")
    lab.near("Drucker-Prager: plane strain as Mohr-Coulomb", found["q"][-1], 98310.6, 1e-4)


def cam_clay_undrained(lab):
    far = engineering(0.4)
    found, point = lab.test("undrained", "cam_clay", dict(CLAY, ocr=1),
                            f"triaxial,cell=100e3,drainage=undrained,strain={far!r},rows=400")
    for strain, right, tolerance in ((0.01, 46207.7, 1e-2), (0.05, 57076.4, 2e-3), (0.1, 57420.3, 2e-3)):
        row = min(range(len(point["eyy"])), key=lambda n: abs(point["eyy"][n] + strain))
        lab.near(f"Cam-Clay: undrained, q at {100 * strain:g} %", found["q"][row], right, tolerance)
    lab.near("Cam-Clay: undrained strength, OCR 1", found["q"][-1], 57434.9, 2e-3)
    lab.near("Cam-Clay: its pore pressure", found["pore_pressure"][-1], 1e5 - (57434.9 - 57434.9 / 3), 2e-3)
    found, _ = lab.test("undrained_4", "cam_clay", dict(CLAY, ocr=4),
                        f"triaxial,cell=100e3,drainage=undrained,strain={engineering(0.5)!r},rows=500")
    lab.near("Cam-Clay: undrained peak, OCR 4", max(found["q"]), 178565, 3e-3)
    lab.near("Cam-Clay: undrained end, OCR 4", found["q"][-1], 174110, 3e-3)


def cam_clay_drained(lab):
    found, point = lab.test("drained", "cam_clay", dict(CLAY, ocr=1),
                            f"triaxial,cell=100e3,strain={engineering(1.5)!r},rows=750", "--parts", "20")
    for strain, right in ((0.05, 66433.0), (0.1, 93749.5), (0.2, 123400)):
        below = max(n for n in range(len(point["eyy"])) if -point["eyy"][n] <= strain + 1e-9)
        share = (strain + point["eyy"][below]) / (point["eyy"][below] - point["eyy"][below + 1])
        lab.near(f"Cam-Clay: drained, q at {100 * strain:g} %",
                 found["q"][below] + share * (found["q"][below + 1] - found["q"][below]), right, 5e-3)
    lab.near("Cam-Clay: drained strength", found["q"][-1], 150000, 5e-3)
    lab.near("Cam-Clay: specific volume at failure", point["specific_volume"][-1], 1.80800, 5e-3)


def cam_clay_constant_mean(lab):
    """At a constant mean stress p the plastic volume follows the yield surface: with Pc = p (1 + (q/(M p))^2) specific volume
    falls by (lambda - kappa) ln(Pc/Pc0) as long as q rises, and at the critical state q = M p."""
    found, point = lab.test("mean", "cam_clay", dict(CLAY, ocr=1), f"triaxial,cell=100e3,constant=p,strain={engineering(1.5)!r},"
                            "rows=750", "--parts", "20")
    lab.near("Cam-Clay: q = M p at the critical state", found["q"][-1], 1e5, 1e-3)
    lab.near("Cam-Clay: specific volume there", point["specific_volume"][-1], 2 - 0.16 * math.log(2), 1e-3)
    for n in (25, 50, 100, 300):
        pc = 1e5 * (1 + (found["q"][n] / 1e5) ** 2)
        lab.near(f"Cam-Clay: Pc at row {n} of constant p", point["preconsolidation"][n], pc, 1e-4)
        lab.near(f"Cam-Clay: specific volume at row {n}", point["specific_volume"][n], 2 - 0.16 * math.log(pc / 1e5), 1e-3)
    for key in (max, min):
        lab.near(f"Cam-Clay: {key.__name__} of p", key(found["p"]), 1e5, 1e-6)
    found, point = lab.test("mean_dense", "cam_clay", dict(CLAY, ocr=8), "triaxial,cell=100e3,constant=p,rows=750,"
                            f"strain={engineering(1.5)!r}", "--parts", "20")
    lab.near("Cam-Clay: dense clay at constant p, q at the end", found["q"][-1], 1e5, 2e-3)
    lab.near("Cam-Clay: its specific volume", point["specific_volume"][-1], 2 + 0.16 * math.log(8 / 2), 2e-3)
    found, _ = lab.test("mean_extension", "cam_clay", dict(CLAY, ocr=1), "triaxial,cell=100e3,constant=p,rows=750,strain=3,"
                        "direction=extension", "--parts", "20")
    lab.near("Cam-Clay: extension at constant p", found["q"][-1], -1e5, 1e-3)
    undrained, point = lab.test("mean_undrained", "cam_clay", dict(CLAY, ocr=1), "triaxial,cell=100e3,drainage=undrained,strain=0.05")
    # the same path by sums: no volume, and q of each row is given, after what the test found
    q = [b - a for a, b in zip([0.0] + undrained["q"], undrained["q"])]
    rows = {"dt": [1.0] * len(q), "dexx+deyy+dezz": [0.0] * len(q), "dsyy-0.5*dsxx-0.5*dszz": [-x for x in q],
            "dsxx-dszz": [0.0] * len(q), **{key: [-1e5] * len(q) for key in ("sxx", "syy", "szz")}}
    path = lab.folder / f"sums_{lab.precision}.csv"
    write_path(path, rows)
    table = run_point(lab.binary, lab.folder / f"sums_{lab.precision}", deck_of("cam_clay", **dict(CLAY, ocr=1)), path,
                      "-element_parts", 20, "-precision", lab.precision)
    for n in (10, 30, 60):
        lab.near(f"Cam-Clay: undrained by sums, strain of row {n}", table["eyy"][n], point["eyy"][n], 1e-3)
        lab.near(f"Cam-Clay: undrained by sums, mean stress of row {n}", sum(table[s][n] for s in ("sxx", "syy", "szz")),
                 sum(point[s][n] for s in ("sxx", "syy", "szz")), 1e-4)


def cam_clay_k0(lab):
    found, _ = lab.test("k0", "cam_clay", dict(CLAY, ocr=1), "oedometer,vertical=100e3,stress=800e3,rows=400")
    lab.near("Cam-Clay: K0 of normal consolidation", found["lateral_stress"][-1] / found["vertical_stress"][-1], 0.71903, 2e-3)
    found, _ = lab.test("k0_consolidated", "cam_clay", dict(CLAY, ocr=1),
                        "triaxial,from=20e3,consolidation=k0,vertical=200e3,drainage=undrained,strain=0.1,rows=200")
    lab.near("Cam-Clay: K0 consolidation, K0", found["lateral_stress"][0] / found["vertical_stress"][0], 0.71903, 2e-3)
    lab.near("Cam-Clay: K0 consolidation, vertical stress", found["vertical_stress"][0], 2e5, 1e-6)
    lab.near("Cam-Clay: strain counts from the end of consolidation", 1 + abs(found["axial_strain"][0]), 1, 1e-12)


def clay_isotropic(lab):
    """Along the normal compression line v falls by lambda times the logarithm of P, and by kappa on the way back."""
    found, point = lab.test("isotropic", "cam_clay", dict(CLAY, ocr=1), "isotropic,cell=100e3,stress=400e3:50e3:800e3,rows=300")
    v = [point["specific_volume"][n] for n in (0, 300, 600, 900)]
    # d(ln v) = -(lambda/v) d(ln P), so that v falls by lambda ln P
    lab.near("Cam-Clay: isotropic loading", v[0] - v[1], 0.2 * math.log(4), 1e-3)
    lab.near("Cam-Clay: isotropic unloading", v[2] - v[1], 0.04 * math.log(8), 1e-3)
    lab.near("Cam-Clay: reloading to the line again", v[0] - v[3], 0.2 * math.log(8), 1e-3)
    lab.near("Cam-Clay: void ratio of the results", found["void_ratio"][-1], v[3] - 1, 1e-6)
    parameters = dict(bulk_modulus=2e7, pressure_reference=1e5, exponent=0.5, poisson=0.25)
    found, point = lab.test("power", "power_elastic", parameters, "isotropic,cell=10e3,stress=329868.3")
    lab.near("power elasticity: volume strain", -sum(point[e][-1] for e in ("exx", "eyy", "ezz")), 0.015, 1e-6)


def rates(lab):
    found, _ = lab.test("softening", "softening_clay", SOFT, "shear,vertical=1e3,hold=volume,strain=5,rate=0.1,rows=1000")
    lab.near("softening clay: shear stress at gamma = 5", found["shear_stress"][-1], 1363.137, 1e-6)
    found, _ = lab.test("grains", "mu_i", GRAINS, "shear,vertical=500,hold=volume,strain=0.02,rate=20")
    lab.near("mu(I): shear stress at 20 1/s", found["shear_stress"][-1], 199.5561, 1e-6)
    for exponent, right in ((1, 130), (0.5, 52.3607)):
        found, _ = lab.test(f"paste_{exponent}", "yield_stress_fluid", dict(PASTE, exponent=exponent),
                            "shear,vertical=100,hold=volume,strain=0.5,rate=20,rows=400")
        lab.near(f"yield-stress fluid, exponent {exponent}", found["shear_stress"][-1], right, 1e-6)


def cycles(lab):
    """A cycle of the elastic-plastic shear of Tresca's clay: between -su and su, and the stiffness of unloading is 2 G."""
    found, point = lab.test("cyclic", "tresca", dict(young=5e5, poisson=0.49, su=1000),
                            "shear,vertical=1e3,hold=volume,amplitude=0.02,cycles=2,rows=50")
    lab.near("Tresca: cyclic shear, largest", max(found["shear_stress"]), 1000, 1e-6)
    lab.near("Tresca: cyclic shear, least", min(found["shear_stress"]), -1000, 1e-6)
    modulus = (found["shear_stress"][51] - found["shear_stress"][50]) / (found["shear_strain"][51] - found["shear_strain"][50])
    lab.near("Tresca: unloading modulus", modulus, 5e5 / (2 * 1.49), 1e-5)
    lab.near("Tresca: five stages of rows", len(found["time"]), 251, 1e-12)


def measured_file(folder, name, columns, noise, seed):
    """A data file of the columns with noise of a part of each ordinate's range."""
    dice, names = random.Random(seed), list(columns)
    spans = {c: max(columns[c]) - min(columns[c]) for c in names}
    lines = ["# made data", ",".join(names)]
    for row in zip(*columns.values()):
        lines.append(",".join(repr(x + (dice.gauss(0, noise) * spans[c] if k else 0))
                              for k, (c, x) in enumerate(zip(names, row))))
    path = folder / name
    path.write_text("\n".join(lines) + "\n")
    return path


def check_fit(lab, name, out, right, most):
    """The fitted values are right within four standard errors and within a part of themselves."""
    fitted = dict(line.split("#")[0].split() for line in (out / "fitted.opts").read_text().splitlines() if line[0] == "-")
    errors = {line.split("#")[0].split()[0]: float(line.split("standard error ")[1].split()[0].rstrip(";"))
              for line in (out / "fitted.opts").read_text().splitlines() if line[0] == "-"}
    for key, value in right.items():
        found, error = float(fitted[f"-soil_{key}"]), errors[f"-soil_{key}"]
        print(f"{name}: {key} = {found:.6g} +- {error:.3g}, made with {value:g}")
        if not abs(found - value) <= 4 * error:
            lab.faults.append(f"{name}: {key} is {found:g} +- {error:g}, made with {value:g}")
        if not abs(found / value - 1) <= most:
            lab.faults.append(f"{name}: {key} is {found:g}, made with {value:g}")


def fit_sand(lab):
    """Three drained triaxial tests with 1 % noise: stiffness, strength and dilation are found again."""
    words, folder = [], lab.folder / f"fit_sand_{lab.precision}"
    folder.mkdir(parents=True, exist_ok=True)
    for n, cell in enumerate((50e3, 100e3, 200e3)):
        found, _ = lab.test(f"made_sand_{n}", "mohr_coulomb", SAND, f"triaxial,cell={cell},strain=0.08,rows=60")
        data = measured_file(folder, f"cd_{n}.csv", {c: found[c] for c in ("axial_strain", "q", "volume_strain")}, 0.01, n)
        words += ["--test", f"triaxial,cell={cell},data={data},name=cd{n}"]
    guess = dict(SAND, young=4e7, cohesion=1000, friction_deg=36, dilation_deg=3)
    out, text = lab.run("fit_sand", deck_of("mohr_coulomb", **guess), *words, "--fit", "young=5e6:100e6", "--fit",
                        "friction_deg=20:45", "--fit", "dilation_deg=0:20", "--fit", "cohesion=0:20e3")
    check_fit(lab, "fit of sand", out, {k: SAND[k] for k in ("young", "friction_deg", "dilation_deg", "cohesion")}, 0.1)
    # the piece of a deck that it wrote is one
    (out / "again.opts").write_text(deck_of("mohr_coulomb", poisson=0.3) + f"-options_file {out / 'fitted.opts'}\n")
    path = out / "path.csv"
    write_path(path, {"dt": [1, 1], "eyy": [0, -1e-4], "syy": [-1e5] * 2})
    run_point(lab.binary, out / "again", (out / "again.opts").read_text(), path)


def fit_clay(lab):
    """An undrained triaxial test and an oedometer test with unloading: M, lambda and kappa are found again."""
    soil, folder = dict(CLAY, ocr=1.5), lab.folder / f"fit_clay_{lab.precision}"
    folder.mkdir(parents=True, exist_ok=True)
    course = {"cu": "triaxial,cell=100e3,drainage=undrained,strain=0.1", "oed": "oedometer,vertical=50e3,stress=800e3:100e3:1600e3"}
    columns = {"cu": ("axial_strain", "q", "pore_pressure"), "oed": ("vertical_stress", "void_ratio")}
    words = []
    for n, (name, test) in enumerate(course.items()):
        found, _ = lab.test(f"made_{name}", "cam_clay", soil, test + ",rows=40")
        data = measured_file(folder, f"{name}.csv", {c: found[c] for c in columns[name]}, 0.005, 10 + n)
        words += ["--test", f"{test},data={data},name={name},rows=60"]
    guess = dict(soil, critical_state_ratio=1.3, kappa=0.03)
    guess["lambda"] = 0.3
    out, _ = lab.run("fit_clay", deck_of("cam_clay", **guess), *words, "--fit", "critical_state_ratio=0.6:1.6", "--fit",
                     "lambda=0.1:0.5", "--fit", "kappa=0.01:0.09")
    check_fit(lab, "fit of clay", out, {k: soil[k] for k in ("critical_state_ratio", "lambda", "kappa")}, 0.05)


def refusals(lab):
    """Tests that cannot be meant end with status 2 and one line."""
    deck = lab.folder / "deck.opts"
    deck.write_text(deck_of("mohr_coulomb", **SAND))
    (lab.folder / "bad.csv").write_text("strain,q\n0,1\n")
    triaxial = "triaxial,cell=1e5"
    for words, fragment in (
            (["--test", "vane"], "takes a kind first"), (["--test", "triaxial"], "cell is not given"),
            (["--test", "triaxial,cell=-1"], 'cell: given "-1"'), (["--test", triaxial + ",cell=2e5"], "takes each key once"),
            (["--test", triaxial + ",speed=2"], "takes KEY=VALUE of"), (["--test", triaxial + ",drainage=no"], "takes drained or"),
            (["--test", triaxial + ",strain=1.5"], "less than 1"), (["--test", triaxial + ",strain=a"], "takes numbers"),
            (["--test", triaxial + ",consolidation=k0"], "takes from=STRESS"), (["--test", triaxial + ",constant=q"], "takes cell or p"),
            (["--test", triaxial + ",constant=p,drainage=undrained"], "takes nothing with drainage=undrained"),
            (["--test", "oedometer,vertical=1e4,constant=p"], "takes KEY=VALUE of"), (["--test", "oedometer,vertical=1e4"], "stress="),
            (["--test", triaxial + f",data={lab.folder / 'none.csv'}"], "takes a CSV file"),
            (["--test", triaxial + f",data={lab.folder / 'bad.csv'}"], "columns axial_strain"),
            (["--test", triaxial, "--fit", "young=1:2"], "takes a --test with data=FILE"),
            (["--test", triaxial, "--option", "-materials a,b"], "takes one material"),
            (["--test", triaxial, "--option", "-soil_friction_deg 80"], "-soil_friction_deg"),
            (["--test", triaxial + ",name=a", "--test", triaxial + ",name=a"], "that no other test has")):
        result = subprocess.run([sys.executable, str(SCRIPT), str(deck), "--out", str(lab.folder / "refused"), "--mpm",
                                 str(lab.binary), *words], capture_output=True, text=True, timeout=100)
        if result.returncode != 2 or fragment not in result.stderr or len(result.stderr.splitlines()) != 1:
            lab.faults.append(f"{' '.join(words)}: status {result.returncode}, {result.stderr!r}, expected {fragment}")


def pipe(lab):
    """A path in a named pipe is refused, and nobody waits for it."""
    fifo = lab.folder / "pipe.csv"
    os.mkfifo(fifo)
    lines = run_point(lab.binary, lab.folder / "piped", deck_of("mohr_coulomb", **SAND), fifo, status=2)
    if len(lines) != 1 or "takes a regular file; this is a pipe" not in lines[0]:
        lab.faults.append(f"a named pipe: {lines}")


CHECKS = [clays, sand_triaxial, sand_constant_mean, sand_k0_start, sand_shear, sand_oedometer, cone_biaxial,
          cam_clay_undrained, cam_clay_drained, cam_clay_constant_mean, cam_clay_k0, clay_isotropic, rates, cycles, fit_sand, fit_clay, refusals, pipe]
ONCE = {fit_sand, fit_clay, refusals, pipe}  # in double precision alone


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--precisions", default="double,single")
    arguments = parser.parse_args()
    os.environ.setdefault("MPLBACKEND", "Agg")
    faults, done = [], 0
    with scratch_folder() as folder:
        for precision in arguments.precisions.split(","):
            lab = Laboratory(pathlib.Path(arguments.binary).resolve(), folder, precision)
            for check in CHECKS:
                if all(word in check.__name__ for word in arguments.words) and (precision == "double" or check not in ONCE):
                    check(lab)
                    done += 1
            faults += lab.faults
    print("\n".join(faults) or f"{done} checks passed")
    sys.exit(1 if faults or not done else 0)


main()
