"""Parts of explorations: beliefs about rooms, the worth of actions, and how far robots may go out of contact."""

from .... import _guard as _guard
