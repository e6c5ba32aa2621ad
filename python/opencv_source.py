# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Gets OpenCV's Python bindings generator and NumPy conversions out of its source package.

    opencv_source.py DIRECTORY [ARCHIVE]

Unpacks modules/python/src2 into DIRECTORY: from ARCHIVE if given, else from the package that pip downloads. The
version is pinned, the hash is checked, and the half megabyte that is used is kept in the user's cache.
"""
import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PACKAGE = "opencv-contrib-python-headless"
VERSION = "4.14.0.94"
SHA256 = "6cd98a20010c80bf9e6a9cff6189dd2c10bd111fb0aa4d5c6361389514a0ff6c"
FOLDER = "/opencv/modules/python/src2/"


def cache_directory():
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "opencv_refract" / SHA256[:16]


def download(directory):
    """The source package, by pip. pip checks the hash before it looks into the package."""
    requirements = directory / "requirements.txt"
    requirements.write_text(f"{PACKAGE}=={VERSION} --hash=sha256:{SHA256}\n")
    subprocess.run([sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", PACKAGE,
                    "--dest", str(directory), "--requirement", str(requirements)], check=True)
    return next(directory.glob("*.tar.gz"))


def check(archive):
    digest = hashlib.sha256()
    with open(archive, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            digest.update(block)
    if digest.hexdigest() != SHA256:
        sys.exit(f"{archive} is not {PACKAGE} {VERSION}: its SHA-256 is {digest.hexdigest()}, not {SHA256}")


def unpack(archive, directory):
    with tarfile.open(archive) as tar:
        for member in tar:
            _, found, path = member.name.partition(FOLDER)
            if found and member.isfile():
                target = directory / path
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(tar.extractfile(member).read())


def fill(cache, archive):
    """Unpacks into a directory beside the cache, which then takes its name: a cache is whole or not there."""
    cache.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache.parent) as work:
        if not archive:
            archive = download(Path(work))
            check(archive)
        unpack(archive, Path(work) / "src2")
        try:
            os.rename(Path(work) / "src2", cache)
        except OSError:
            if not cache.is_dir():      # else another build was faster
                raise


def main(directory, archive=None):
    if archive and Path(archive).is_file():
        check(archive)      # also where the cache has what is wanted: the caller may link what else the archive holds
    cache = cache_directory()
    if not cache.is_dir():
        try:
            fill(cache, archive)
        except (subprocess.CalledProcessError, StopIteration):
            sys.exit(f"pip could not download the source package of {PACKAGE} {VERSION}")
        except (OSError, tarfile.TarError) as error:
            sys.exit(f"could not unpack the source package of {PACKAGE} {VERSION}: {error}")
    shutil.copytree(cache, directory, dirs_exist_ok=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
