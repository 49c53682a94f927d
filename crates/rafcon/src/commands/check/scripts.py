# Reads scripts without running them: {"scripts": [text, ...]} in, a list of what was found in each out.
import ast
import json
import sys
import warnings


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


def examine(text):
    try:
        tree = compile(text, "script.py", "exec", ast.PyCF_ONLY_AST, dont_inherit=True)
        compile(tree, "script.py", "exec", dont_inherit=True)
    except SyntaxError as error:
        return {"syntax": {"line": error.lineno, "message": error.msg or "invalid syntax"}}
    except (ValueError, MemoryError, RecursionError) as error:
        return {"syntax": {"line": None, "message": str(error) or type(error).__name__}}
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "execute"]
    if not functions:
        coroutines = [node for node in tree.body if isinstance(node, ast.AsyncFunctionDef) and node.name == "execute"]
        return {"execute": any(map(binds_execute, tree.body)), "async": [node.lineno for node in coroutines]}
    execute = functions[-1]
    found = sorted(returns(execute), key=lambda node: node.lineno)
    return {
        "execute": True,
        "line": execute.lineno,
        "takes_four": bool(execute.decorator_list) or takes_four(execute.args),
        "returns_nothing": all(node.value is None for node in found),
        "raises": any(isinstance(node, ast.Raise) for node in ast.walk(execute)),
        "outcomes": [[node.lineno, outcome] for node in found if node.value for outcome in outcomes(node.value)],
    }


warnings.simplefilter("ignore")
request = json.loads(sys.stdin.buffer.read().decode("utf-8", "surrogatepass"))
sys.stdout.write(json.dumps([examine(text) for text in request["scripts"]]))
