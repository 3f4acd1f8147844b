"""The source papers, number by number: published, computed, and who is right."""
