"""The figures that the paper prints, a module each."""
