"""Makes packages of interface files usable for ``rclpy``: by the generators in the Python packages of ROS, and the compiler of the computer.

``python generate.py FOLDER``, with the Python of a virtual environment that has ``rclpy``; each package in FOLDER comes into it.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

os.environ["AMENT_PREFIX_PATH"] = sys.prefix

from ament_index_python import get_package_share_directory
from rosidl_generator_c.cli import GenerateC
from rosidl_generator_py.cli import GeneratePython
from rosidl_typesupport_c.cli import GenerateCTypesupport
from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

PYTHON = "rosidl_typesupport_c"
#: How messages are written to the wire, and how the middleware learns of what they are made.
WIRE, KIND = "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"
#: Packages whose libraries hold what interfaces are made of.
BASES = ("builtin_interfaces", "unique_identifier_msgs", "action_msgs", "service_msgs", "std_msgs", "geometry_msgs")
RUNTIME = ("rosidl_runtime_c", PYTHON, WIRE, KIND, "rosidl_typesupport_fastrtps_cpp", "fastcdr", "rcutils", "rmw")


def generate(package, share, work, packages):
    """Writes the sources: what is Python's into ``packages``, the rest into ``work``, for generators name their files alike."""
    files = [f"{package}:{file.relative_to(package)}" for file in sorted(package.glob("*/*.*"))]
    include = [str(share), str(package.parent)]
    for kind in (
        GenerateC("c"),
        GenerateFastRTPSCTypesupport("wire"),
        GenerateIntrospectionCTypesupport("kind"),
        GenerateCTypesupport("dispatch", typesupport_implementations=[WIRE, KIND]),
    ):
        kind.generate(package.name, list(files), include, work / kind.name / package.name)
    GeneratePython("py", typesupport_implementations=[PYTHON]).generate(package.name, list(files), include, packages / package.name)


def compile_all(name, work, packages, prefix):
    """Compiles the sources into a library, and the extension module that the package imports."""
    numpy = subprocess.check_output([sys.executable, "-c", "import numpy; print(numpy.get_include())"], text=True).strip()
    headers = [sysconfig.get_path("include"), numpy, *work.iterdir(), prefix / "include", *sorted((prefix / "include").glob("*"))]
    flags = ["-O0", "-w", "-fPIC", *(f"-I{folder}" for folder in headers)]
    known = [f"-l:lib{base}__{kind}.so" for base in BASES for kind in ("rosidl_generator_c", "rosidl_generator_py", PYTHON, WIRE, KIND)]
    known = [each for each in known + [f"-l:lib{each}.so" for each in RUNTIME] if (prefix / "lib" / each[3:]).exists()]
    link = [f"-L{prefix / 'lib'}", f"-Wl,-rpath,{prefix / 'lib'},--allow-shlib-undefined", *known]

    def objects(folder):
        for number, source in enumerate(sorted(each for each in folder.rglob("*") if each.suffix in (".c", ".cpp"))):
            made = folder / f"{number}.o"
            subprocess.run(["gcc", *flags, "-c", str(source), "-o", str(made)], check=True)
            yield made

    shared = prefix / "lib" / f"lib{name}__{WIRE}.so"
    subprocess.run(["g++", "-shared", *objects(work), *link, "-o", str(shared)], check=True)
    package = packages / name
    module = package / f"{name}_s__{PYTHON}{sysconfig.get_config_var('EXT_SUFFIX')}"
    subprocess.run(["g++", "-shared", *objects(package), *link, f"-l:{shared.name}", "-o", str(module)], check=True)
    # The middleware opens a library for each of the two.
    other = prefix / "lib" / f"lib{name}__{KIND}.so"
    other.unlink(missing_ok=True)
    other.symlink_to(shared.name)


def main(folder):
    share = pathlib.Path(get_package_share_directory("builtin_interfaces")).parent
    packages = pathlib.Path(sysconfig.get_path("purelib"))
    for package in sorted(each for each in folder.iterdir() if each.is_dir()):
        shutil.rmtree(packages / package.name, ignore_errors=True)
        with tempfile.TemporaryDirectory() as work:
            generate(package, share, pathlib.Path(work), packages)
            (packages / package.name / "__init__.py").touch()
            compile_all(package.name, pathlib.Path(work), packages, share.parent)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
