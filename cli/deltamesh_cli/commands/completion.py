"""`deltamesh completion`: a script with which a shell completes command lines of deltamesh."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

from deltamesh_cli.epilogs import epilog

_SHELLS = ("bash", "zsh", "fish")

_EXAMPLES = """\
deltamesh completion bash > ~/.deltamesh.bash
deltamesh completion zsh > ~/.zfunc/_deltamesh
deltamesh completion fish > ~/.config/fish/completions/deltamesh.fish
"""

_SETUP = (
    """\
bash loads the file of the first example if ~/.bashrc has the line
  . ~/.deltamesh.bash""",
    """\
zsh searches the folder of the second example, which you have to create, if
~/.zshrc has the lines
  fpath+=~/.zfunc
  autoload -Uz compinit && compinit""",
)


@click.command(epilog=epilog(_EXAMPLES, *_SETUP))
@click.argument("shell", type=click.Choice(_SHELLS))
@click.pass_context
def command(ctx: click.Context, shell: str) -> None:
    """Print a script that completes command lines.

    With the script, the TAB key completes commands, options, their values and file names. Shells
    have to be started anew to use it. bash has to be version 4.4 or newer.
    """
    completion = get_completion_class(shell)
    if completion is None:
        raise click.ClickException(f"this version of click does not support {shell}")
    group = ctx.find_root().command
    script = completion(group, {}, "deltamesh", "_DELTAMESH_COMPLETE")
    click.echo(script.source_template % script.source_vars())
