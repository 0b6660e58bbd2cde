"""The parts of `deltamesh batch`: options, plan, engines, work on one file, run and report."""
