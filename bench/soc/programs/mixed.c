// SPDX-License-Identifier: Apache-2.0
// Integer code similar to CoreMark: searches, reverses and sorts a linked list, multiplies small matrices, parses
// numbers with a state machine, and computes a CRC over all results.
#include <stdint.h>

#define NODES 40
#define SIZE 10
#define TEXT 240

struct node {
  struct node* next;
  int16_t key;
  int16_t data;
};

static struct node nodes[NODES];
static int16_t a[SIZE][SIZE];
static int16_t b[SIZE][SIZE];
static int32_t c[SIZE][SIZE];
static char text[TEXT + 1];

static __attribute__((noinline)) uint16_t crc(uint16_t sum, uint32_t value) {
  for (int i = 0; i < 32; ++i) {
    const uint32_t bit = (sum ^ value) & 1;
    sum >>= 1;
    value >>= 1;
    if (bit) sum ^= 0xa001;
  }
  return sum;
}

static __attribute__((noinline)) struct node* find(struct node* list, int16_t key) {
  while (list && list->key != key) list = list->next;
  return list;
}

static __attribute__((noinline)) struct node* reverse(struct node* list) {
  struct node* done = 0;
  while (list) {
    struct node* next = list->next;
    list->next = done;
    done = list;
    list = next;
  }
  return done;
}

static int by_key(const struct node* x, const struct node* y) {
  return x->key - y->key;
}
static int by_data(const struct node* x, const struct node* y) {
  return (x->data & 0xff) - (y->data & 0xff);
}

/// Uses bottom-up merge sort.
static __attribute__((noinline)) struct node* sort(struct node* list,
                                                   int (*order)(const struct node*, const struct node*)) {
  for (int width = 1;; width *= 2) {
    struct node* rest = list;
    struct node** tail = &list;
    int merges = 0;
    while (rest) {
      struct node* left = rest;
      int lefts = 0;
      while (rest && lefts < width) {
        rest = rest->next;
        ++lefts;
      }
      struct node* right = rest;
      int rights = width;
      ++merges;
      while (lefts > 0 || (rights > 0 && right)) {
        struct node* next;
        if (lefts > 0 && (rights == 0 || !right || order(left, right) <= 0)) {
          next = left;
          left = left->next;
          --lefts;
        } else {
          next = right;
          right = right->next;
          --rights;
        }
        *tail = next;
        tail = &next->next;
      }
      rest = right;
    }
    *tail = 0;
    if (merges <= 1) return list;
  }
}

static __attribute__((noinline)) uint16_t work_on_list(uint16_t sum, int turn) {
  struct node* list = 0;
  for (int i = 0; i < NODES; ++i) {
    nodes[i].key = (int16_t)((i * 17 + turn) % NODES);
    nodes[i].data = (int16_t)(i * 193 + turn);
    nodes[i].next = list;
    list = &nodes[i];
  }
  list = sort(list, by_data);
  for (int key = 0; key < NODES; key += 3) {
    const struct node* found = find(list, (int16_t)key);
    if (found) sum = crc(sum, (uint16_t)found->data);
    list = reverse(list);
  }
  list = sort(list, by_key);
  return crc(sum, (uint32_t)list->next->data);
}

static __attribute__((noinline)) uint16_t work_on_matrices(uint16_t sum, int turn) {
  int32_t trace = 0;
  for (int i = 0; i < SIZE; ++i) {
    for (int j = 0; j < SIZE; ++j) {
      a[i][j] = (int16_t)(i * j + turn);
      b[i][j] = (int16_t)(i - j * turn);
    }
  }
  for (int i = 0; i < SIZE; ++i) {
    for (int j = 0; j < SIZE; ++j) {
      int32_t cell = 0;
      for (int k = 0; k < SIZE; ++k) cell += a[i][k] * b[k][j];
      c[i][j] = cell;
    }
  }
  for (int i = 0; i < SIZE; ++i) {
    for (int j = 0; j < SIZE; ++j) trace += (c[i][j] >> 2 & 15) * (c[j][i] >> 5 & 127);
  }
  return crc(sum, (uint32_t)trace);
}

enum state { START, SIGN, WHOLE, FRACTION, EXPONENT, WRONG, STATES };

static enum state step(enum state state, char ch) {
  const int digit = ch >= '0' && ch <= '9';
  switch (state) {
    case START:
      return digit ? WHOLE : ch == '+' || ch == '-' ? SIGN : ch == '.' ? FRACTION : WRONG;
    case SIGN:
      return digit ? WHOLE : ch == '.' ? FRACTION : WRONG;
    case WHOLE:
      return digit ? WHOLE : ch == '.' ? FRACTION : ch == 'e' ? EXPONENT : WRONG;
    case FRACTION:
      return digit ? FRACTION : ch == 'e' ? EXPONENT : WRONG;
    case EXPONENT:
      return digit || ch == '-' ? EXPONENT : WRONG;
    default:
      return WRONG;
  }
}

static __attribute__((noinline)) uint16_t work_on_text(uint16_t sum, int turn) {
  static const char* const words[] = {"12", "+7.25", "-0.5e3", "abc", "1e-9", "..", "3.14159", "-x"};
  uint32_t ends[STATES] = {0};
  int length = 0;
  for (int i = turn; length < TEXT - 10; i += 3) {
    for (const char* w = words[i & 7]; *w; ++w) text[length++] = *w;
    text[length++] = ',';
  }
  text[length] = 0;
  enum state state = START;
  for (const char* at = text; *at; ++at) {
    if (*at == ',') {
      ++ends[state];
      state = START;
    } else {
      state = step(state, *at);
    }
  }
  for (int i = 0; i < STATES; ++i) sum = crc(sum, ends[i]);
  return sum;
}

int main(void) {
  uint16_t sum = 0;
  for (int turn = 0; turn < TURNS; ++turn) {
    sum = work_on_list(sum, turn & 15);
    sum = work_on_matrices(sum, turn & 31);
    sum = work_on_text(sum, turn & 7);
  }
  return sum;
}
