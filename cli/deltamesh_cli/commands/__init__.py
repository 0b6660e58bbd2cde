"""Commands, one module each; `command` in it is the click command of the module's name."""
