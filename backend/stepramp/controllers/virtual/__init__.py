"""The virtual controller: one of the family `stepramp`, with nothing attached."""
