#!/usr/bin/env python3
"""The recipes of scripts/site/image install the wheel of a build on a bare Debian 12: their own steps run in a tree that debootstrap makes,
and soil-mpm, mpm and mpirun run there.

usage: test_image.py BUILD_FOLDER

Exit status 77 without root, debootstrap, patchelf, or a mirror of Debian's packages. It takes the sources of packages, the certificates and the
settings of pip from this machine. It does not need Docker, Podman or Apptainer, and does not show that they read the recipes.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import test_bundle

IMAGE = test_bundle.SOURCE / "scripts" / "site" / "image"
OF_MACHINE = ["etc/resolv.conf", "etc/hosts", "etc/pip.conf", "etc/ssl/certs", "usr/local/share/ca-certificates", "etc/apt/sources.list.d",
              "etc/apt/sources.list"]
RUNS = """
set -e
cd /tmp
soil-mpm run footing_coarse --no-pictures -time_end 0.01
mpm -version
mpirun -n 2 --bind-to none mpm -options_file /opt/mpm/lib/python3*/site-packages/soil_mpm/inputs/footing_coarse.opts -time_end 0.01 -output_dir out/ranks
"""


def mirror():
    """A mirror of Debian 12 as this machine names it; None where it names none."""
    texts = [path.read_text() for path in pathlib.Path("/etc/apt").rglob("*") if path.suffix in (".list", ".sources") and path.is_file()]
    found = re.search(r"^(?:URIs:|deb)\s+(?:\[[^]]*\]\s+)?(\S+)", "\n".join(texts), re.MULTILINE)
    return found[1] if found and "bookworm" in "\n".join(texts) else None


def container_steps():
    """The RUN lines of the last stage of Containerfile."""
    return re.findall(r"^RUN (.*)$", (IMAGE / "Containerfile").read_text().rpartition("\nFROM ")[2], re.MULTILINE)


def apptainer_steps():
    """The lines of %post in mpm.def."""
    return [line.strip() for line in re.search(r"^%post\n(.*?)\n\n", (IMAGE / "mpm.def").read_text(), re.DOTALL | re.MULTILINE)[1].splitlines()]


def copied(container):
    """[(place in the source, place in the image)] of COPY or %files."""
    if container:
        line = re.search(r"^COPY --from=source (.*)$", (IMAGE / "Containerfile").read_text(), re.MULTILINE)[1]
        *sources, to = line.split()
        return [(source.removeprefix("/src/"), to + pathlib.PurePath(source).name if source.endswith("steps") else to) for source in sources]
    lines = re.search(r"^%files\n(.*?)\n\n", (IMAGE / "mpm.def").read_text(), re.DOTALL | re.MULTILINE)[1].split("\n")
    return [tuple(line.split()) for line in lines]


class Recipes(unittest.TestCase):
    def test_both_do_the_same(self):
        self.assertEqual(container_steps(), apptainer_steps())
        self.assertEqual({source for source, _ in copied(True)}, {source for source, _ in copied(False)})
        for source, _ in copied(True):
            self.assertTrue(source == "build/wheel" or (test_bundle.SOURCE / source).is_file(), source)

    def test_steps(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder) / "root"
            subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root, mirror()], check=True, stdout=subprocess.DEVNULL)
            (root / "etc/apt/sources.list").unlink()
            for name in OF_MACHINE:
                place = pathlib.Path("/") / name
                if place.is_dir():
                    shutil.copytree(place, root / name, symlinks=False, dirs_exist_ok=True, ignore_dangling_symlinks=True)
                elif place.exists():
                    shutil.copyfile(place, root / name)
            subprocess.run([test_bundle.SOURCE / "scripts" / "wheel", "--build", test_bundle.BUILD, root / "wheel"], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            shutil.copy(IMAGE / "steps", root / "wheel")
            mounts = 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" /bin/sh -c "$1"'
            for words in [*apptainer_steps(), RUNS]:
                done = subprocess.run(["unshare", "--mount", "sh", "-c", mounts, root, words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                      env={"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "OMP_NUM_THREADS": "1"})
                self.assertEqual(done.returncode, 0, done.stdout[-3000:])
            self.assertIn("finished after", done.stdout)


if __name__ == "__main__":
    if subprocess.run(["id", "-u"], capture_output=True, text=True).stdout.strip() != "0" or not mirror() or not all(
            map(shutil.which, ("debootstrap", "unshare", "patchelf"))):
        sys.exit(77)
    unittest.main()
