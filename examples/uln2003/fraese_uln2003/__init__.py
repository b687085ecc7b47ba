"""Two unipolar motors on ULN2003 boards, four data bits each: a card in a package of its own."""
