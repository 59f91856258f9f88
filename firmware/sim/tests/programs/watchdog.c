/* Counts its starts in RAM that the C start-up leaves alone, then waits for the watchdog; stops for good at the third. */
#include <avr/io.h>
#include <avr/interrupt.h>
#include <avr/wdt.h>

volatile uint8_t starts __attribute__((section(".noinit")));
volatile uint8_t cause;

int main(void) {
    uint8_t flags = MCUSR;
    MCUSR = 0;
    wdt_disable();
    cause = flags;
    starts = (flags & _BV(WDRF)) ? starts + 1 : 1;
    DDRB |= _BV(5);
    PORTB |= _BV(5);
    if (starts < 3) wdt_enable(WDTO_15MS);
    /* Timer1 goes on counting edges of D8 after a reset as before. */
    TCCR1B = _BV(CS10);
    for (;;) {}
}
