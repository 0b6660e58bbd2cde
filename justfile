# Verbs for those who work on deltamesh: `just test`, `just lint`. They expect an environment with
# `pip install -e '.[dev]'`.

# Run the tests; `just test --slow` runs all.
test *arguments:
    python -m pytest {{arguments}}

# Write the golden and the refused files anew; only when the file format changes. With --add, only
# those that are missing.
golden *options:
    PYTHONPATH=tests/support:tests/oracles:tests/reference_decoder python tests/make_golden.py {{options}}

# Check style and layers.
lint:
    ruff check
    ruff format --check
    lint-imports

# Check types.
types:
    mypy

# Put the sources into shape.
format:
    ruff check --fix
    ruff format

# Write cli/README.md from the commands' help.
reference:
    python cli/make_reference.py

# Make the man pages.
man folder="build/man":
    python cli/make_man.py {{folder}}

# Build the site of the documentation.
site folder="build/site":
    mkdocs build --strict --site-dir {{folder}}

# Make the mesh that the repository carries.
meshes:
    python benchmarks/make_meshes.py

# Measure sizes and errors, write benchmarks/results.csv; or `just bench speed` and others there.
bench script="run" *arguments:
    python benchmarks/{{script}}.py {{arguments}}

# Everything, in a fresh virtual environment.
ci:
    .ci/run
