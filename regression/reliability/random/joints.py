"""Chains and rings of rigid bodies with joints of all kinds, springs and dashpots, in the air and on soil.

The joints are closed at every row; what each body gains of momentum is the impulse of soil, gravity, springs and joints; a linkage
that nothing touches keeps its energy, and one that no joint holds to the ground its momentum and angular momentum too. The mirror image
moves as the mirror.
"""
import numpy as np

from deck import Deck, changer, rounded, vector
from mpm_regression.folders import history

SPIN = {2: ("",), 3: ("_x", "_y", "_z")}


def rotated(angle, arm):
    """An arm turned by rotation vectors (rad): one number a row in 2D, three in 3D."""
    if angle.shape[1] == 1:
        c, s = np.cos(angle[:, 0]), np.sin(angle[:, 0])
        return np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)
    size = np.linalg.norm(angle, axis=1, keepdims=True)
    axis = angle / np.maximum(size, 1e-300)
    arms = np.broadcast_to(arm, axis.shape)
    return (np.cos(size) * arms + np.sin(size) * np.cross(axis, arms)
            + (1 - np.cos(size)) * axis * (axis * arms).sum(axis=1, keepdims=True))


class Joints(Deck):
    strategies = ("tile", "tile", "gather", "sequential")
    apart = {"double": 1e-6, "single": 0.2}  # chains that swing and hit soil amplify round-off

    def make(self):
        draw, dim = self.draw, self.dim
        self.weight = draw.choice([0.0, 9.81])
        self.gravity = [0.0] * (dim - 1) + [-self.weight]
        self.top = [4.0, *[2.0] * (dim - 2), 3.0]
        self.on_soil = draw.random() < 0.4
        ground = 1.0 if self.on_soil else 0.25
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(self.top)} -mesh_spacing {0.125 if dim == 2 else 0.25} "
                        f"-mesh_{self.up}max free -mesh_xmin smooth -mesh_xmax smooth -materials soil -bodies ground -ground_material soil "
                        f"-ground_shape box -ground_lower {vector([0] * dim)} -ground_upper {vector([*self.top[:-1], ground])} "
                        "-soil_model von_mises -soil_su 4e3 -soil_density 1700 -soil_young 2e6 -soil_poisson 0.3 "
                        f"-gravity {vector(self.gravity)} -time_end 0.2 -time_step 4e-4 -history_interval 0.01 -output_interval 0.1").split()
        height = 1.3 if self.on_soil else 2.0
        self.bodies = {name: self.body(name, 0.7 + 0.8 * k, height) for k, name in enumerate(draw.choice([["a", "b"], ["a", "b", "c"], ["a", "b", "c", "d"]]))}
        self.joints = self.draw_joints()
        self.options += ["-rigid_bodies", ",".join(self.bodies), "-joints", ",".join(self.joints)]
        self.options += [word for thing in (*self.bodies.values(), *self.joints.values()) for word in thing["words"]]

    def body(self, name, x, height):
        draw, dim = self.draw, self.dim
        centre = np.round([x, *[1.0] * (dim - 2), height + draw.uniform(-0.1, 0.1)], 6)
        mass, inertia = round(draw.uniform(100, 400), 3), round(draw.uniform(5, 20), 3)
        turns = draw.random() < 0.85
        words = [f"-{name}_shape", "disc" if dim == 2 else "ball", f"-{name}_centre", vector(centre), f"-{name}_radius", "0.2", f"-{name}_motion", "dynamic",
                 f"-{name}_mass", str(mass), f"-{name}_velocity", rounded(draw.uniform(-0.5, 0.5) for _ in range(dim))]
        sprung = draw.random() < 0.2
        if turns:
            words += [f"-{name}_free", "x,y,rz" if dim == 2 else "x,y,z,rx,ry,rz", f"-{name}_inertia",
                      str(inertia) if dim == 2 else vector([inertia] * 3 + [0] * 3),
                      f"-{name}_angular_velocity", rounded(draw.uniform(-1, 1) for _ in SPIN[dim])]
        if sprung:
            spins = len(SPIN[dim])
            words += [f"-{name}_stiffness", rounded([draw.uniform(0, 1e4)] * dim + [draw.uniform(0, 300) if turns else 0] * spins),
                      f"-{name}_viscosity", rounded([draw.uniform(0, 100)] * dim + [0] * spins)]
        return {"centre": centre, "mass": mass, "inertia": inertia, "turns": turns, "sprung": sprung, "words": words}

    def draw_joints(self):
        """Each body and the next one, perhaps the first one and the ground, and perhaps a rod from the last to the first."""
        draw, names, joints = self.draw, list(self.bodies), {}
        for k, (one, two) in enumerate(zip(names, names[1:])):
            joints[f"j{k}"] = self.joint(f"j{k}", one, two)
        if draw.random() < 0.6:
            joints["pin"] = self.joint("pin", names[0], "ground")
        if len(names) > 2 and draw.random() < 0.4:
            joints["tie"] = self.joint("tie", names[-1], names[0], ["rod", "cable"])
        return joints

    def joint(self, name, one, two, kinds=("ball", "hinge", "slider", "weld", "rod", "cable")):
        draw, dim = self.draw, self.dim
        kind = draw.choice(kinds)
        from_, to = self.bodies[one]["centre"], self.bodies[two]["centre"] if two in self.bodies else self.bodies[one]["centre"] + [0.3] * dim
        joint = {"kind": kind, "bodies": (one, two), "driven": False}
        words = [f"-{name}_kind", kind, f"-{name}_bodies", f"{one},{two}"]
        if kind in ("rod", "cable"):
            joint["point"], joint["other"] = np.round(from_ + 0.15 * (to - from_), 6), np.round(to - 0.1 * (to - from_), 6)
            words += [f"-{name}_other_point", vector(joint["other"])]
            joint["length"] = float(np.linalg.norm(joint["point"] - joint["other"]))
            if kind == "cable":
                joint["length"] = np.ceil(1e6 * joint["length"] * draw.choice([1.000001, 1.02])) / 1e6
                words += [f"-{name}_length", str(joint["length"])]
        else:
            joint["point"] = np.round((from_ + to) / 2, 6)
        words += [f"-{name}_point", vector(joint["point"])]
        if kind == "slider" or (kind == "hinge" and dim == 3):
            words += [f"-{name}_axis", rounded(draw.uniform(0.2, 1) for _ in range(dim))]
        joint["stops"] = kind == "hinge" and draw.random() < 0.3
        if joint["stops"]:
            words += [f"-{name}_stop_deg", f"{-draw.uniform(1, 20):.4f},{draw.uniform(1, 20):.4f}"]
        if two == "ground" and draw.random() < 0.3:
            joint["driven"] = True
            words += [f"-{name}_velocity", rounded(draw.uniform(-0.3, 0.3) for _ in range(dim))]
            joint["velocity"] = np.array([float(x) for x in words[-1].split(",")])
        return {**joint, "words": words}

    # ------------------------------------------------------------------------------------------ checks

    def place(self, values, body, point):
        """Where a point of a body is, a row each."""
        at = self.bodies[body]
        moved = np.stack([values[f"{body}_{axis}"] for axis in self.axes], axis=1)
        angle = np.stack([values[f"{body}_angle{end}"] for end in SPIN[self.dim]], axis=1) if at["turns"] else np.zeros((len(moved), len(SPIN[self.dim])))
        return at["centre"] + moved + rotated(angle, np.asarray(point) - at["centre"])

    def check(self, folder):
        values = history(folder)
        for name, joint in self.joints.items():
            self.check_closed(values, name, joint)
        for name, body in self.bodies.items():
            self.check_momentum(values, name, body)
        touched = any(np.abs(values[f"{name}_force_{axis}"]).max() > 0 for name in self.bodies for axis in self.axes)
        held = any("ground" in joint["bodies"] for joint in self.joints.values()) or not all(body["turns"] for body in self.bodies.values())
        loses = any(joint["kind"] == "cable" or joint["stops"] or joint["driven"] for joint in self.joints.values())
        sprung = any(body["sprung"] for body in self.bodies.values())
        if not touched and not loses and not sprung:
            self.check_energy(values)
        if not touched and not held and not sprung and self.weight == 0:
            self.check_angular_momentum(values)

    def check_closed(self, values, name, joint):
        one, two = joint["bodies"]
        start = self.place(values, one, joint["point"])
        far = joint.get("other", joint["point"])
        if two == "ground":
            end = far + values["time"][:, None] * joint.get("velocity", np.zeros(self.dim))
        else:
            end = self.place(values, two, far)
        apart = np.linalg.norm(start - end, axis=1)
        if joint["kind"] in ("ball", "hinge", "weld"):
            off = apart.max()
        elif joint["kind"] == "rod":
            off = np.abs(apart - joint["length"]).max()
        elif joint["kind"] == "cable":
            off = max((apart - joint["length"]).max(), 0)
        else:
            return
        self.note("distance of a joint from what it holds (m)", off)
        assert off < 2e-9, f"{name}, a {joint['kind']}, is {off:.3g} m open"

    def check_momentum(self, values, name, body):
        t = values["time"]
        for axis, g in zip(self.axes, self.gravity):
            rate = values[f"{name}_force_{axis}"] + body["mass"] * g
            if body["sprung"]:
                rate = rate + values[f"{name}_spring_force_{axis}"]
            for key, joint in self.joints.items():
                sign = {joint["bodies"][0]: 1, joint["bodies"][1]: -1}.get(name, 0)
                rate = rate + sign * values[f"{key}_force_{axis}"]
            momentum, gained = body["mass"] * values[f"{name}_velocity_{axis}"], np.cumsum(rate[1:] * np.diff(t))
            parts = sum(np.abs(values[f"{key}_force_{axis}"][1:] * np.diff(t)).sum() for key in self.joints)
            scale = np.abs(momentum).max() + np.abs(rate[1:] * np.diff(t)).sum() + parts
            error = np.abs(momentum[1:] - momentum[0] - gained).max() / scale
            self.note("momentum of a body off its impulse", error)
            assert error < 1e-7, f"{name}: its momentum {axis} is {error:.3g} off the impulse on it"

    def energies(self, values):
        kinetic = total = 0
        for name, body in self.bodies.items():
            square = sum(values[f"{name}_velocity_{axis}"] ** 2 for axis in self.axes)
            if body["turns"]:
                square = square + body["inertia"] / body["mass"] * sum(values[f"{name}_angular_velocity{end}"] ** 2 for end in SPIN[self.dim])
            kinetic = kinetic + body["mass"] * square / 2
            total = total + body["mass"] * (square / 2 + self.weight * values[f"{name}_{self.up}"])
        return kinetic, total

    def check_energy(self, values):
        """From the second row on: velocities that the joints do not allow at the start are lost in the first step."""
        kinetic, total = self.energies(values)
        off = np.ptp(total[1:]) / kinetic[1:].max()
        self.note("change of the energy of a linkage over the largest kinetic one", off)
        assert off < 1e-3, f"the energy changes by {off:.3g} of the kinetic one"

    def check_angular_momentum(self, values):
        dim, total, size = self.dim, 0, 0
        for name, body in self.bodies.items():
            x = self.place(values, name, body["centre"])
            v = np.stack([values[f"{name}_velocity_{axis}"] for axis in self.axes], axis=1)
            w = np.stack([values[f"{name}_angular_velocity{end}"] for end in SPIN[dim]], axis=1)
            of_way = (x[:, :1] * v[:, 1:] - x[:, 1:] * v[:, :1]) if dim == 2 else np.cross(x, v)
            part = body["inertia"] * w + body["mass"] * of_way
            total, size = total + part, size + np.abs(part).max()
        off = np.abs(total - total[0]).max() / size
        self.note("change of the angular momentum of a free linkage", off)
        assert off < 1e-9, f"the angular momentum changes by {off:.3g}"

    def compare(self, whole):
        """The mirror image across the middle plane of x."""
        if not self.exact:
            return
        mine, theirs = history(self.go("image", options=self.mirror())), history(whole)
        for name in self.bodies:
            for what, sign in (("x", -1), ("velocity_x", -1), (self.up, 1)):
                off = np.abs(sign * mine[f"{name}_{what}"] - theirs[f"{name}_{what}"]).max() / (np.abs(theirs[f"{name}_{what}"]).max() + 1)
                self.note("difference of the mirror image", off)
                assert off < 1e-5, f"the mirror image: {name}_{what} is {off:.3g} apart"

    def mirror(self):
        words, width = list(self.options), self.top[0]
        change = changer(words)

        for name in self.bodies:
            change(f"-{name}_centre", lambda c: [width - c[0], *c[1:]])
            change(f"-{name}_velocity", lambda v: [-v[0], *v[1:]])
            change(f"-{name}_angular_velocity", lambda w: [-w[0]] if len(w) == 1 else [w[0], -w[1], -w[2]])
        for name in self.joints:
            for key in ("point", "other_point"):
                change(f"-{name}_{key}", lambda c: [width - c[0], *c[1:]])
            for key in ("axis", "velocity"):
                change(f"-{name}_{key}", lambda v: [-v[0], *v[1:]])
            change(f"-{name}_axis", lambda v: v)
            if self.joints[name]["stops"]:  # a hinge turns the other way; its axis in 3D is a pseudovector, of which the image has the sign
                change(f"-{name}_stop_deg", lambda s: [-s[1], -s[0]])
        return words
