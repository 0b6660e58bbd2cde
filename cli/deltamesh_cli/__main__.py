"""`python -m deltamesh_cli`, the same as `deltamesh`."""

from deltamesh_cli import main

main()
