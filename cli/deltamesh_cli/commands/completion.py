"""`deltamesh completion`: what a shell needs to complete command lines of deltamesh."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

from deltamesh_cli import options

_SHELLS = ("bash", "zsh", "fish")

_EXAMPLES = """\
deltamesh completion bash > ~/.deltamesh.bash
deltamesh completion zsh > ~/.zfunc/_deltamesh
deltamesh completion fish > ~/.config/fish/completions/deltamesh.fish
"""

_WHERE = (
    """\
bash reads the file of the first example if ~/.bashrc has the line
  . ~/.deltamesh.bash""",
    """\
zsh looks into the folder of the second one, which you make, if ~/.zshrc has
  fpath+=~/.zfunc
  autoload -Uz compinit && compinit""",
)


@click.command(epilog=options.epilog(_EXAMPLES, *_WHERE))
@click.argument("shell", type=click.Choice(_SHELLS))
@click.pass_context
def command(ctx: click.Context, shell: str) -> None:
    """Print a script that completes command lines.

    With it the TAB key completes commands, options, their values and names of files. It holds for
    shells that are started afterwards. bash has to be 4.4 or newer.
    """
    found = get_completion_class(shell)
    if found is None:
        raise click.ClickException(f"this version of click does not know {shell}")
    group = ctx.find_root().command
    script = found(group, {}, "deltamesh", "_DELTAMESH_COMPLETE")
    click.echo(script.source_template % script.source_vars())
