/* Toggles pins at cycles that can be counted by hand, latches INT0 while it is off, and paints its stack. */
#include <avr/io.h>
#include <avr/interrupt.h>

volatile uint8_t int0_runs;
volatile uint8_t flag_before, flag_after;

ISR(INT0_vect) { int0_runs++; }

__attribute__((noinline)) static uint8_t deep(uint8_t n) {
    volatile uint8_t local[100];
    for (uint8_t i = 0; i < 100; i++) local[i] = n;
    return local[n % 100];
}

int main(void) {
    DDRB |= _BV(5);
    __asm__ volatile(
        "cli\n"
        "sbi %[port], 5\n" /* 2 cycles */
        "nop\n"
        "nop\n"
        "nop\n"
        "cbi %[port], 5\n" /* 5 after the first */
        "sbi %[pin], 5\n"  /* 7: toggles to high */
        "sbi %[pin], 5\n"  /* 9 */
        "cbi %[ddr], 5\n"
        :
        : [port] "I"(_SFR_IO_ADDR(PORTB)), [pin] "I"(_SFR_IO_ADDR(PINB)), [ddr] "I"(_SFR_IO_ADDR(DDRB)));
    /* Pull-up on an input, released output. */
    PORTC |= _BV(0);
    DDRC |= _BV(0);
    PORTC &= ~_BV(0);
    DDRC &= ~_BV(0);
    PORTC |= _BV(0);
    (void)deep(7);

    /* Edges while INT0 is off are latched; the flag is cleared by writing 1. */
    EICRA = _BV(ISC01);
    EIFR = _BV(INTF0);
    PORTD |= _BV(2);
    sei();
    DDRB |= _BV(4);
    PORTB |= _BV(4); /* the test plays two falling edges now */
    while (!(PIND & _BV(7))) {}
    flag_before = EIFR;
    EIMSK = _BV(INT0);
    __asm__ volatile("nop\nnop\n");
    flag_after = EIFR;
    EIMSK = 0;
    PORTB &= ~_BV(4);
    while (PIND & _BV(7)) {}
    flag_before |= EIFR << 4;
    EIFR = _BV(INTF0);
    EIMSK = _BV(INT0);
    __asm__ volatile("nop\nnop\n");
    PORTB |= _BV(4);
    for (;;) {}
}
