"""Reading what a run leaves behind: plateaus, fields, closed forms and figures."""
