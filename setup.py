"""Compiles what ``fraese/compiled.py`` lists, with mypyc; all else is in ``pyproject.toml``.

Where there is no C compiler, or it fails, nothing is compiled, and the sources are what runs.
``FRAESE_PLAIN=1`` compiles nothing either: so a pure wheel is made.

What the compiler is told is here, and in no module that it compiles.
"""

import io
import os
import runpy
import sys
import sysconfig
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from setuptools import Distribution, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
#: ``fraese/compiled.py``, without the package.
COMPILED = runpy.run_path(str(ROOT / "fraese" / "compiled.py"))
SOURCES = [str(path.relative_to(ROOT)) for path in COMPILED["sources"](ROOT / "fraese")]
MYPYC = "mypy>=2.4"
WORKERS = os.cpu_count() or 1
#: What all of them are linked into, ``fraese/compiled__mypyc``; the C is written below ``BUILD``.
GROUP = "fraese.compiled"
BUILD = Path("build", "c")


def has_compiler() -> bool:
    """A C compiler, and what Python's modules in C include."""
    from setuptools._distutils.ccompiler import new_compiler
    from setuptools._distutils.sysconfig import customize_compiler

    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "tried.c"
        source.write_text("#include <Python.h>\n")
        try:
            compiler = new_compiler()
            customize_compiler(compiler)
            include = sysconfig.get_path("include")
            compiler.compile([str(source)], output_dir=folder, include_dirs=[include])
        except Exception:
            return False
    return True


def is_wanted() -> bool:
    """Whether anything is to be compiled."""
    return os.environ.get(COMPILED["PLAIN"], "") in ("", "0") and has_compiler()


WANTED = is_wanted()


class House(Distribution):
    """A wheel is one for any machine where nothing is compiled."""

    def has_ext_modules(self) -> bool:
        """What is compiled is made out when it is built: that takes a while."""
        return WANTED


class Compile(build_ext):
    """Translates the modules to C, and compiles that on all cores."""

    def run(self) -> None:
        """Where it fails, the sources have to do."""
        if not WANTED:
            return
        began_s = time.time()
        digest = COMPILED["digest"](ROOT / "fraese")
        try:
            self._translate()
            super().run()
        except (Exception, SystemExit) as error:
            print(f"fraese stays plain: it could not be compiled ({error}).", file=sys.stderr)
            self.extensions = self.distribution.ext_modules = []
            return
        if self.inplace:
            self._tidy()
            COMPILED["stamp"](ROOT / "fraese", digest, began_s)

    def _tidy(self) -> None:
        """What is not listed any more must not be found beside its source."""
        made = {(ROOT / self.get_ext_filename(each.name)).resolve() for each in self.extensions}
        for file in (ROOT / "fraese").rglob("*" + sysconfig.get_config_var("EXT_SUFFIX")):
            if file.resolve() not in made:
                file.unlink()

    def _translate(self) -> None:
        from mypyc.build import mypycify

        # Types alone count here; how strict they are is seen to by `make check`.
        options = ["--config-file=", "--follow-imports=silent", "--ignore-missing-imports"]
        # Where it could be faster still is nothing to who starts the app for the first time.
        said = io.StringIO()
        try:
            with redirect_stdout(said), redirect_stderr(said):
                made = mypycify(
                    [*options, *SOURCES],
                    group_name=GROUP,
                    target_dir=str(BUILD),
                    multi_file=True,
                    opt_level="1",
                    debug_level="0",
                )
        except BaseException:
            print(said.getvalue(), file=sys.stderr)
            raise
        for extension in made:
            extension.include_dirs.append(str(BUILD / "fraese"))
        self.distribution.ext_modules = made
        # Options are finalized once more, with what there is to build now; this one cannot be.
        self.swig_opts = None
        self.finalized = 0
        self.ensure_finalized()

    def build_extensions(self) -> None:
        """One file in C is compiled beside the other, and those alone that have changed."""
        compile_all = self.compiler.compile
        headers_at_s = max(header.stat().st_mtime for header in BUILD.rglob("*.h"))

        def compile_one(source: str, options: dict[str, Any]) -> str:
            made = self.compiler.object_filenames([source], output_dir=self.build_temp)[0]
            newest_s = max(headers_at_s, os.path.getmtime(source))
            if not os.path.exists(made) or os.path.getmtime(made) <= newest_s:
                compile_all([source], **options)
            return made

        def compile_each(sources: list[str], **options: Any) -> list[str]:
            with ThreadPoolExecutor(WORKERS) as pool:
                return list(pool.map(lambda source: compile_one(source, options), sources))

        self.compiler.compile = compile_each
        super().build_extensions()


if not WANTED and os.environ.get(COMPILED["PLAIN"], "") in ("", "0"):
    print(
        "fraese stays plain: there is no C compiler, or Python's headers are missing.",
        file=sys.stderr,
    )

setup(
    distclass=House,
    cmdclass={"build_ext": Compile},
    # Where it is there already nobody has to fetch it.
    setup_requires=[MYPYC] if WANTED and find_spec("mypyc") is None else [],
)
