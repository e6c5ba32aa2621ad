#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What compiling costs: builds the library and the tools from nothing, without a compiler cache, and prints the processor time of
the compiler, in seconds and as a multiple of what one source with Eigen's JacobiSVD takes (a yardstick for any machine), and the
sources that take longest. Times of a busy machine are too long, their ratio hardly."""
import argparse
import pathlib
import resource
import subprocess
import sys

LONGEST = 12            # sources to list
YARDSTICK = """#include <Eigen/SVD>
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& A)
{
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
    return svd.matrixV()*svd.singularValues().cwiseInverse().asDiagonal()*svd.matrixU().transpose();
}
"""


def processor_seconds(command):
    """User time of a command, and its exit code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    code = subprocess.call(command)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, code


def launch(log, command):
    """As CMake's compiler launcher: notes what the compiler took."""
    seconds, code = processor_seconds(command)
    source = command[-1]
    with open(log, "a", encoding="utf-8") as file:
        file.write(f"{seconds:.3f} {source}\n")
    return code


def yardstick(folder):
    source = folder / "yardstick.cpp"
    source.write_text(YARDSTICK, encoding="utf-8")
    return processor_seconds(["c++", "-std=c++17", "-O2", "-DNDEBUG", "-I/usr/include/eigen3", "-c", str(source),
                              "-o", str(source) + ".o"])[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", nargs="?", help="where to build (default: build/compile_time)")
    parser.add_argument("target", nargs="*", help="what to build, e.g. refract_tests (default: library and tools)")
    arguments = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    folder = pathlib.Path(arguments.directory or root / "build" / "compile_time").resolve()
    targets = arguments.target or ["all"]
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "seconds.log"
    log.unlink(missing_ok=True)
    others = "OFF" if targets == ["all"] else "ON"
    subprocess.check_call(["cmake", "-S", str(root), "-B", str(folder), "-G", "Ninja", f"-DREFRACT_BUILD_TESTS={others}",
                           "-DREFRACT_BUILD_SAMPLES=OFF", f"-DREFRACT_BUILD_BENCH={others}",
                           f"-DCMAKE_CXX_COMPILER_LAUNCHER={sys.executable};{pathlib.Path(__file__).resolve()};--launch;{log}"],
                          stdout=subprocess.DEVNULL)
    units = [yardstick(folder)]
    subprocess.check_call(["cmake", "--build", str(folder), "--clean-first", "--target", *targets], stdout=subprocess.DEVNULL)
    units.append(yardstick(folder))
    unit = sum(units)/len(units)
    took = [(float(line.split()[0]), line.split(maxsplit=1)[1].strip()) for line in log.read_text(encoding="utf-8").splitlines()]
    total = sum(seconds for seconds, _ in took)
    for seconds, source in sorted(took, reverse=True)[:LONGEST]:
        print(f"{seconds:7.1f} s  {seconds/unit:5.2f} x  {source.replace(str(root) + '/', '')}")
    print(f"{total:7.0f} s  {total/unit:5.1f} x  all {len(took)} sources; x = {unit:.2f} s, one source with JacobiSVD")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--launch"]:
        sys.exit(launch(sys.argv[2], sys.argv[3:]))
    main()
