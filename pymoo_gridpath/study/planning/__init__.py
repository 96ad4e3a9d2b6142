"""From what a study says to the runs that it means."""
