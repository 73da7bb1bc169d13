"""Starts goalbench with the libraries of the installed packages: libtorch of torch, libmujoco of mujoco, and the robot
models of gymnasium-robotics. None of them is imported, so that starting takes no longer for it."""
import importlib.metadata
import importlib.util
import os
import sys
from pathlib import Path

# Package, module, the version that the program is built for (or how it begins), and what of it is needed.
NEEDED = [
    ("torch", "torch", "2.11.", "lib/libtorch_cpu.so"),
    ("mujoco", "mujoco", "3.3.7", "libmujoco.so.3.3.7"),
    ("gymnasium-robotics", "gymnasium_robotics", "1.4.2", "envs/assets/fetch/reach.xml"),
]


def folder_of(package, module, version, proof):
    try:
        found = importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        sys.exit(f"goalbench: {package} is not installed; pip install '{package}=={version.rstrip('.')}'")
    if not (found + ".").startswith(version.rstrip(".") + "."):
        sys.exit(f"goalbench: {package} {found} is installed; this build needs {version.rstrip('.')}")
    spec = importlib.util.find_spec(module)
    for folder in (spec.submodule_search_locations or []) if spec else []:
        if (Path(folder) / proof).is_file():
            return Path(folder)
    sys.exit(f"goalbench: {package} {found} is installed without {proof}")


def main():
    torch, mujoco, robotics = (folder_of(*needed) for needed in NEEDED)
    libraries = [str(torch / "lib"), str(mujoco), os.environ.get("LD_LIBRARY_PATH", "")]
    os.environ["LD_LIBRARY_PATH"] = ":".join(filter(None, libraries))
    os.environ.setdefault("GOALBENCH_ASSETS", str(robotics / "envs" / "assets"))
    program = str(Path(__file__).with_name("bin") / "goalbench")
    os.execv(program, [program, *sys.argv[1:]])


if __name__ == "__main__":
    main()
