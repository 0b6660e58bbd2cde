"""`python -m deltamesh_cli`, which does the same as `deltamesh`."""

from deltamesh_cli import main

main()
