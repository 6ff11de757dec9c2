/* Prints the size of every struct of the C interface and the place of each of its members, one a line. Other languages
   repeat these numbers; tests/abi/layout.txt holds them. */
#include <pointskin/c.h>

#include <stdio.h>

#define STRUCT(type) printf("%s %zu\n", #type, sizeof(type))
#define MEMBER(type, name) printf("%s.%s %zu %zu\n", #type, #name, offsetof(type, name), sizeof(((type*)0)->name))

int main(void) {
#include "layout_members.inc"
  return 0;
}
