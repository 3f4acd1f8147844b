"""Who sees how many satellites, and with what geometry."""
