"""The methods that make a path fast, each with a way to switch it off."""
