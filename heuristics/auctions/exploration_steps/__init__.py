"""What exploring robots believe of rooms, what an action is worth to them, and how far they may go out of contact."""

from .... import _guard as _guard
