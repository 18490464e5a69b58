// @ts-check
// The layouts that more than style sheets have to know of; layout.css says what each is for, and asks the same.

/** There is room for one plot at a time. */
export const ONE_PLOT = matchMedia('(max-width: 700px), (max-height: 640px)');
/** What explains a parameter is shown when it is asked for. */
export const SHORT = matchMedia('(max-width: 700px), (max-height: 500px)');
