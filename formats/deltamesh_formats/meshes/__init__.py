"""One module a format and direction: `x_in.read` takes bytes apart, `x_out.write` is its mirror."""
