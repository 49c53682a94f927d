# Reads scripts without running them: {"scripts": [text, ...]} in, a list of what was found in each out.
import ast
import json
import re
import sys
import warnings

# A line that a merge of version control leaves in a text.
MARKER = re.compile(r"(<<<<<<<|>>>>>>>)( |$)")


def outcomes(value):
    """The constant outcomes that an expression can have: names and numbers."""
    if isinstance(value, ast.IfExp):
        return outcomes(value.body) + outcomes(value.orelse)
    if isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.USub):
        return [-number for number in outcomes(value.operand) if isinstance(number, int)]
    if isinstance(value, ast.Constant) and type(value.value) in (str, int):
        return [value.value]
    return []


def returns(function):
    """Every return statement of a function, not those of functions inside it."""
    open_nodes = list(function.body)
    while open_nodes:
        node = open_nodes.pop()
        if isinstance(node, ast.Return):
            yield node
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)):
            open_nodes.extend(ast.iter_child_nodes(node))


def takes_four(arguments):
    positional = len(getattr(arguments, "posonlyargs", [])) + len(arguments.args)
    needed = positional - len(arguments.defaults)
    keywords = any(default is None for default in arguments.kw_defaults)
    return needed <= 4 and (positional >= 4 or arguments.vararg is not None) and not keywords


def binds_execute(node):
    """Whether something at the top level of the module gives the name a value; a star import may."""
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return any((alias.asname or alias.name) in ("execute", "*") for alias in node.names)
    if isinstance(node, ast.Name):
        return node.id == "execute" and isinstance(node.ctx, ast.Store)
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return node.name == "execute"
    if isinstance(node, ast.Lambda):
        return False
    return any(binds_execute(child) for child in ast.iter_child_nodes(node))


def text_of(node):
    """The text of a constant."""
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None


def subscripts(function, name, context):
    """Lines and constant keys with which a dictionary is read or written, not in a `try` that may be meant to fail."""
    open_nodes = list(function.body)
    while open_nodes:
        node = open_nodes.pop()
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == name:
            index = node.slice.value if type(node.slice).__name__ == "Index" else node.slice
            if isinstance(node.ctx, context) and text_of(index) is not None:
                yield node.lineno, text_of(index)
        if isinstance(node, ast.Try) and node.handlers:
            open_nodes.extend(node.orelse + node.finalbody + [part for each in node.handlers for part in each.body])
        else:
            open_nodes.extend(ast.iter_child_nodes(node))


def names_in(function, name):
    """Texts that are compared with the keys of a dictionary, or written into it."""
    known = set()
    for node in ast.walk(function):
        if isinstance(node, ast.Compare) and any(isinstance(each, ast.Name) and each.id == name for each in node.comparators):
            known.update(filter(None, [text_of(node.left)]))
    known.update(key for _line, key in subscripts(function, name, ast.Store))
    return known


def is_given_anew(function, name):
    return any(
        isinstance(node, ast.Name) and node.id == name and not isinstance(node.ctx, ast.Load) for node in ast.walk(function)
    )


def ports(execute):
    """The ports that `execute` reads and writes by constant names."""
    names = [argument.arg for argument in getattr(execute.args, "posonlyargs", []) + execute.args.args]
    if len(names) < 4 or execute.decorator_list:
        return [], []
    inputs, outputs = names[1], names[2]
    read, written = [], []
    if not is_given_anew(execute, inputs):
        known = names_in(execute, inputs)
        read = [pair for pair in subscripts(execute, inputs, ast.Load) if pair[1] not in known]
    if not is_given_anew(execute, outputs):
        written = list(subscripts(execute, outputs, ast.Store))
    return sorted(set(read)), sorted(set(written))


#: The methods of the global variable manager, by what they do.
READS = ("get_variable",)
SETS = ("set_variable", "lock_variable", "set_locked_variable")
ASKS = ("variable_exist", "variable_exists", "is_locked", "delete_variable")


def globals_of(tree):
    """The global variables that are read and set, and whether others may be set."""
    read, changed, asked, sets_any = [], set(), set(), False
    for node in ast.walk(tree):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            names = [alias.name for alias in node.names] + [getattr(node, "module", None) or ""]
            sets_any = sets_any or any("global_variable" in name or name.endswith("singleton") for name in names)
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
            continue
        method, keywords = node.func.attr, {each.arg: each.value for each in node.keywords}
        if method not in READS + SETS + ASKS:
            continue
        first = node.args[0] if node.args else keywords.get("key")
        name = text_of(first) if first is not None else None
        if method in SETS:
            changed.update(filter(None, [name]))
            sets_any = sets_any or name is None
        elif method in ASKS:
            asked.update(filter(None, [name]))
        elif name is not None and len(node.args) < 3 and "default" not in keywords:
            read.append((node.lineno, name))
    return sorted({pair for pair in read if pair[1] not in asked}), sorted(changed), sets_any


def examine(text):
    try:
        tree = compile(text, "script.py", "exec", ast.PyCF_ONLY_AST, dont_inherit=True)
        compile(tree, "script.py", "exec", dont_inherit=True)
    except SyntaxError as error:
        conflict = next((number for number, line in enumerate(text.splitlines(), 1) if MARKER.match(line)), None)
        if conflict is not None:
            return {"conflict": conflict}
        return {"syntax": {"line": error.lineno, "message": error.msg or "invalid syntax"}}
    except (ValueError, MemoryError, RecursionError) as error:
        return {"syntax": {"line": None, "message": str(error) or type(error).__name__}}
    globals_read, globals_set, sets_any_global = globals_of(tree)
    about_globals = {"globals_read": globals_read, "globals_set": globals_set, "sets_any_global": sets_any_global}
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "execute"]
    if not functions:
        coroutines = [node for node in tree.body if isinstance(node, ast.AsyncFunctionDef) and node.name == "execute"]
        found = {"execute": any(map(binds_execute, tree.body)), "async": [node.lineno for node in coroutines]}
        return {**found, **about_globals}
    execute = functions[-1]
    found = sorted(returns(execute), key=lambda node: node.lineno)
    inputs, outputs = ports(execute)
    return {
        **about_globals,
        "inputs": inputs,
        "outputs": outputs,
        "execute": True,
        "line": execute.lineno,
        "takes_four": bool(execute.decorator_list) or takes_four(execute.args),
        "returns_nothing": all(node.value is None for node in found),
        "raises": any(isinstance(node, ast.Raise) for node in ast.walk(execute)),
        "outcomes": [[node.lineno, outcome] for node in found if node.value for outcome in outcomes(node.value)],
    }


def answer(text):
    try:
        return examine(text)
    except RecursionError as error:
        return {"syntax": {"line": None, "message": str(error) or "it is nested too deeply"}}


warnings.simplefilter("ignore")
request = json.loads(sys.stdin.buffer.read().decode("utf-8", "surrogatepass"))
sys.stdout.write(json.dumps([answer(text) for text in request["scripts"]]))
