"""`python -m pointskin` is the program."""
import sys

from .program import main

sys.exit(main())
