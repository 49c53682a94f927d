"""The floor: what CPython alone needs for the two scripts of the flat machine.

Executes the cached code object in a fresh module, makes the two dictionaries and calls ``execute``, and prints how many
states a second that is. Usage: ``call_loop.py MACHINE_FOLDER``.
"""

import glob
import json
import sys
import time
import types

LOOPS = 200_000


def compiled(folder, state):
    (path,) = glob.glob(f"{folder}/*_{state}/script.py")
    with open(path, encoding="utf-8") as file:
        return compile(file.read(), path, "exec")


def main():
    count_code, check_code = (compiled(sys.argv[1], state) for state in ("COUNT", "CHECK"))
    count = 0
    began = time.perf_counter()
    for _ in range(LOOPS):
        module = types.ModuleType("script")
        exec(count_code, module.__dict__)
        inputs, outputs = {"count": count}, {"count": 0}
        module.execute(None, inputs, outputs, None)
        count = outputs["count"]
        module = types.ModuleType("script")
        exec(check_code, module.__dict__)
        inputs, outputs = {"count": count}, {}
        module.execute(None, inputs, outputs, None)
    json.dump({"states_per_s": 2 * LOOPS / (time.perf_counter() - began)}, sys.stdout)


if __name__ == "__main__":
    main()
