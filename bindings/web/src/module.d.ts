// Made by embed.mjs.
export declare const packed: string;
