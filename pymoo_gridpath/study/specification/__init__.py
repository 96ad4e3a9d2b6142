"""What a study consists of: its tables as dataclasses and as a TOML file, checked and expanded to a plan."""
