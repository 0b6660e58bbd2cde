"""The parts of `deltamesh batch`: arguments, plan, engines, work on one file, run and report."""
